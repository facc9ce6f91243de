"""Brings a .glb into Blender's scene."""

import json
import os
import struct

import bpy


def plain(path):
    """The bytes of a .glb without attributes of its own (_NAME): Blender 5 mixes up several of them."""
    with open(path, "rb") as file:
        glb = file.read()
    (length,) = struct.unpack_from("<I", glb, 12)
    root = json.loads(glb[20 : 20 + length])
    for mesh in root.get("meshes", []):
        for primitive in mesh["primitives"]:
            known = primitive["attributes"].items()
            primitive["attributes"] = {name: at for name, at in known if not name.startswith("_")}
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    rest = glb[20 + length :]
    return struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest)) + struct.pack("<I4s", len(text), b"JSON") + text + rest


def imported(path):
    """The objects of a .glb, which come into the scene."""
    before = set(bpy.data.objects)
    # Beside it, as its images may be.
    copy = f"{path}.{os.getpid()}.glb"
    try:
        with open(copy, "wb") as file:
            file.write(plain(path))
        bpy.ops.import_scene.gltf(filepath=copy)
    finally:
        os.remove(copy)
    return [it for it in bpy.data.objects if it not in before]
