"""What leaves the package for other programs: rooms as GLB, MJCF, URDF and USD; frames and expressions as COCO and RefCOCO; walks for Rerun."""
