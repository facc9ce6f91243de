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


@IMPORT@


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
