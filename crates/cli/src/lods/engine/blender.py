"""Imports the levels in the file beside this one, a collection for each, of which the finest is shown.

Written by secateur for Blender 4 and later: blender --python this_file.py, or run it in the text editor.
"""

import json
import os
import struct

import bpy

FILE = os.path.join(os.path.dirname(os.path.abspath(__file__)), @FILE@)

# The node of each level, and from how many metres on it is meant to be drawn.
LEVELS = [
@LEVELS@
]


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


def main():
    objects = imported(FILE)
    for number, (node, begin) in enumerate(LEVELS):
        found = [it for it in objects if it.name.split(".")[0] == node or it.name == node]
        if not found:
            raise RuntimeError(f"{FILE} has no node {node}")
        collection = bpy.data.collections.new(node)
        collection["begin_m"] = begin
        bpy.context.scene.collection.children.link(collection)
        for level in [found[0], *found[0].children_recursive]:
            for other in list(level.users_collection):
                other.objects.unlink(level)
            collection.objects.link(level)
        collection.hide_viewport = number > 0
        collection.hide_render = number > 0


main()
