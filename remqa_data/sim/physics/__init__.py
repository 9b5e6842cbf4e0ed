"""The world that PyBullet simulates: bodies, joints, poses, and what rests on what."""
