"""What leaves the package for other programs: rooms as GLB, MJCF and URDF; frames and expressions as COCO and RefCOCO."""
