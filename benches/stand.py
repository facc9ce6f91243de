#!/usr/bin/env python3
"""A stand of 2,000 plants of five kinds against the same stand at full geometry: what it costs, and how far its pictures
are from those of the plants themselves.

    benches/stand.py FOLDER [--plants 2000] [--program target/release/secateur] [-- OPTIONS OF stand]

FOLDER has the plants (the first five .glb by name, or all there are). Prints a row for each camera and one for the
whole stand as JSON lines: `case`, `quantity`, `value`.
"""

import argparse
import json
import pathlib
import random
import subprocess
import sys
import tempfile

# Metres between plants, and how far each is off its place in the grid.
SPACING = 6.0
JITTER = 0.45

# How high the plants are in metres, in the order of their names.
HEIGHTS_M = [2, 12, 6, 10, 14]

def height(file):
    """The height of a plant in the units of its file."""
    data = file.read_bytes()
    root = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    primitives = [primitive for mesh in root["meshes"] for primitive in mesh["primitives"]]
    bounds = [root["accessors"][primitive["attributes"]["POSITION"]] for primitive in primitives]
    return max(box["max"][1] for box in bounds) - min(box["min"][1] for box in bounds)


def stand(folder, count):
    chance = random.Random(7)
    files = sorted(folder.glob("*.glb"))[:5]
    side = round(count**0.5 + 0.4999)
    plants = [{"file": str(file.resolve()), "places": []} for file in files]
    units = [metres / height(file) for file, metres in zip(files, HEIGHTS_M)]
    for k in range(count):
        x, z = k % side, k // side
        off = [chance.uniform(-JITTER, JITTER) for _ in range(2)]
        kind = chance.randrange(len(plants))
        place = {
            "position": [SPACING * (x + off[0] - side / 2), 0, SPACING * (z + off[1] - side / 2)],
            "turn_degrees": chance.uniform(0, 360),
            "scale": units[kind] * chance.uniform(0.8, 1.25),
        }
        plants[kind]["places"].append(place)
    half = SPACING * side / 2
    cameras = {
        "at the edge": [[0, 2, half + 12], [0, 4, 0]],
        "within": [[3, 2, 3], [-half, 3, -half / 2]],
        "from a hill": [[-half - 20, 30, half + 20], [0, 0, 0]],
        "from above": [[0, 150, 40], [0, 0, 0]],
    }
    cameras_json = [{"eye": eye, "target": target} for eye, target in cameras.values()]
    return {"plants": plants, "cameras": cameras_json}, list(cameras)

def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--plants", type=int, default=2000)
    parser.add_argument("--program", default="target/release/secateur")
    parser.add_argument("--keep", type=pathlib.Path, help="a folder for what is written")
    words = sys.argv[1:]
    split = words.index("--") if "--" in words else len(words)
    args = parser.parse_args(words[:split])
    options = words[split + 1 :] or ["--max-flip", "0.02"]
    with tempfile.TemporaryDirectory() as temporary:
        out = args.keep or pathlib.Path(temporary)
        out.mkdir(exist_ok=True)
        scene, names = stand(args.folder, args.plants)
        (out / "scene.json").write_text(json.dumps(scene))
        command = [args.program, "stand", out / "scene.json", "-o", out, "--overwrite", "-q", *options]
        if subprocess.run(command, check=False).returncode != 0:
            sys.exit("the stand could not be made")
        record = json.loads((out / "stand.json").read_text())
    case = f"{args.plants} plants, {' '.join(options)}"
    rows = [("cost_ratio", record["cost_ratio"])]
    for key in ["plants", "triangles", "draws", "gpu_bytes", "cost"]:
        rows += [(f"{key} before", record["before"][key]), (f"{key} after", record["after"][key])]
    for name, camera in zip(names, record["cameras"]):
        rows += [(f"flip_mean {name}", camera["flip_mean"]), (f"difference {name}", camera["difference"])]
    rows.append(("seconds", record["seconds"]["total"]))
    for quantity, value in rows:
        print(json.dumps({"case": case, "quantity": quantity, "value": value}))

if __name__ == "__main__":
    main()
