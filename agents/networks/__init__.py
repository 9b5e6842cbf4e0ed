"""The networks of agents: pictures and words in, boxes, objects and answers out."""
