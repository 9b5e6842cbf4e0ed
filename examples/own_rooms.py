"""Take a room of a dataset and a sampled one, put something into it, walk about in it, and write it for other programs.

python examples/own_rooms.py out/tiny [OUT]
"""

# %% The dataset
import sys
from dataclasses import replace
from pathlib import Path

import gymnasium

import remqa_data.env  # registers remqa_data/Remqa-v0
from remqa_data.assets.core.model import AssetSpec
from remqa_data.export.rooms import find_scene, write_room
from remqa_data.floorplans.sampled.scenes import sampled_scene
from remqa_data.opencv import cv2
from remqa_data.scene import Scene, SceneObject
from remqa_data.sim import World
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table

arguments = [] if "ipykernel" in sys.modules else sys.argv[1:]
data = Path(arguments[0] if arguments else "out/tiny")
out = Path(arguments[1] if arguments[1:] else "out/examples")
out.mkdir(parents=True, exist_ok=True)

# %% A room as a dataset arranges it
split = load_manifest(data).splits("scenes")[-1]
name = read_table(data, "scenes", split, ["scene"])["scene"][0].as_py()
arranged = find_scene(name, data, configuration=0)
print(f"{name}: {arranged.room_type}, {len(arranged.objects)} objects")

# %% A room that nobody recorded: the same index and seed give the same room
sampled = sampled_scene(index=3, seed=0)
print(f"{sampled.name}: {sampled.room_type}, {len(sampled.objects)} objects")

# %% Put a mug onto something flat, from 5 cm above, and let it come to rest
ON = ("CounterTop", "DiningTable", "Desk", "Dresser", "SideTable", "Toilet", "Stool", "Floor")
MUG_M = (0.08, 0.08, 0.1)
with World(sampled) as world:
    world.settle()
    below = next(thing for kind in ON for thing in world.ids if world.type_of(thing) == kind)
    (x0, y0, _), (x1, y1, top) = world.box(below).tolist()
    rested = world.to_scene()
above = ((x0 + x1) / 2, (y0 + y1) / 2, top + MUG_M[2] / 2 + 0.05)
mug = SceneObject("Mug|mine", AssetSpec("Mug", MUG_M, seed=7), above, is_fixed=False)
with World(replace(rested, objects=(*rested.objects, mug))) as world:
    world.settle()
    mine = world.to_scene()
    print(f"the mug came to rest {world.box('Mug|mine')[0, 2]:.2f} m above the floor, put over {below}")
mine.save(out / "mine.json")
assert Scene.load(out / "mine.json") == mine

# %% Walk about in it: a bare room asks nothing
env = gymnasium.make("remqa_data/Remqa-v0", scenes=[mine])
observation, info = env.reset(seed=1)
for action in ("RotateLeft", "MoveAhead", "MoveAhead"):
    observation, reward, terminated, truncated, info = env.step(action)
    print(action, "done" if info["success"] else f"refused: {info['error']}")
cv2.imwrite(str(out / "mine.png"), observation["rgb"][..., ::-1])
env.close()

# %% Write it for viewers, with all doors and drawers open, and for MuJoCo
files = [*write_room(mine, out / "mine.glb", opened=["all"]), *write_room(mine, out / "mine.xml")]
print("wrote", out / "mine.png", out / "mine.json", files[0], files[-1])
