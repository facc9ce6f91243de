"""The extension in Blender without a window: leaves are found, levels come as collections, and are exported.

Needs bpy, numpy and the wheel of secateur where Python finds modules, and the extension's folder as the argument.
"""

import importlib.util
import os
import sys
import tempfile
import unittest

import bpy
import secateur

PLACE = os.path.join(sys.argv.pop(1), "__init__.py")


def extension():
    """The extension under a name of its own, as Blender has it."""
    described = importlib.util.spec_from_file_location("bl_ext_secateur", PLACE)
    module = importlib.util.module_from_spec(described)
    sys.modules["bl_ext_secateur"] = module
    described.loader.exec_module(module)
    return module


class Extension(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.extension = extension()
        self.extension.register()
        self.addCleanup(self.extension.unregister)
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        path = os.path.join(self.folder.name, "bush.glb")
        self.plant = secateur.grow("bush", 60, 3)
        self.plant.level(triangles=1.0).write(path)
        self.extension.imported(path)
        bpy.ops.object.select_all(action="SELECT")
        self.settings = bpy.context.scene.secateur
        self.settings.name = "bush"

    def test_leaves_are_found_and_levels_are_collections(self):
        self.assertEqual(bpy.ops.secateur.find(), {"FINISHED"})
        self.assertIn(f"{self.plant.leaf_count} leaves, {self.plant.triangle_count} triangles", self.settings.found)
        self.settings.target = "SHARE"
        self.settings.share = 0.5
        self.settings.count = 2
        self.assertEqual(bpy.ops.secateur.levels(), {"FINISHED"})
        place = bpy.data.collections["bush_levels"]
        self.assertEqual([it.name for it in place.children], ["bush_LOD0", "bush_LOD1", "bush_LOD2"])
        counts = []
        for number, level in enumerate(place.children):
            meshes = [it.data for it in level.all_objects if it.type == "MESH"]
            counts.append(sum(len(polygon.vertices) - 2 for mesh in meshes for polygon in mesh.polygons))
            # Blender keeps one of two triangles back to back, which thin twigs end as.
            self.assertTrue(0.8 * level["triangles"] < counts[-1] <= level["triangles"], (counts, level["triangles"]))
            self.assertEqual(level.hide_viewport, number > 0)
        self.assertEqual(place.children[0]["triangles"], self.plant.triangle_count)
        self.assertLessEqual(counts[1], 0.5 * counts[0])
        self.assertLessEqual(counts[2], 0.25 * counts[0])
        begins = [it["begin_m"] for it in place.children]
        self.assertEqual(begins, sorted(begins))

    def test_levels_are_exported(self):
        self.settings.target = "SHARE"
        self.settings.count = 1
        self.settings.folder = os.path.join(self.folder.name, "out")
        for layout, file in [("files", "bush_LOD1.glb"), ("siblings", "bush.glb"), ("usd", "bush.usda")]:
            self.settings.layout = layout
            self.assertEqual(bpy.ops.secateur.export(), {"FINISHED"})
            self.assertTrue(os.path.isfile(os.path.join(self.settings.folder, file)), file)

    def test_what_is_wrong_is_a_sentence(self):
        bpy.ops.object.select_all(action="DESELECT")
        with self.assertRaisesRegex(RuntimeError, "Select the objects of a plant"):
            bpy.ops.secateur.find()
        bpy.ops.object.select_all(action="SELECT")
        with self.assertRaisesRegex(RuntimeError, "Name a folder"):
            bpy.ops.secateur.export()


unittest.main()
