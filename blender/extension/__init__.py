"""Levels of detail of plants: a panel in the sidebar of the 3D view (N), tab secateur.

Select the objects of a plant: it is handed to secateur as glTF, and levels come back as a collection for each.
"""

import os
import tempfile

import bpy
import secateur
from bpy.props import EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from .blender_import import imported

# The collection that holds a plant's levels is called after it.
LEVELS = "{}_levels"


class Failure(Exception):
    """What is wrong, in a sentence for the user."""


def plant_of(context):
    """The plant that the selected objects are, by way of glTF."""
    chosen = [it for it in context.selected_objects if it.type == "MESH"]
    if not chosen:
        raise Failure("Select the objects of a plant: its leaves and its wood")
    name = context.scene.secateur.name.strip() or chosen[0].name.split(".")[0]
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "plant.glb")
        bpy.ops.export_scene.gltf(filepath=path, use_selection=True, export_format="GLB", export_yup=True)
        with open(path, "rb") as file:
            found = file.read()
    leaves = [it for it in context.scene.secateur.leaves.split(",") if it.strip()]
    named = {"foliage": [f"material:{it.strip()}" for it in leaves]} if leaves else {}
    try:
        return secateur.open(found, name=f"{name}.glb", **named), name
    except secateur.Error as error:
        raise Failure(str(error)) from error


def levels_of(context, plant):
    settings = context.scene.secateur
    options = {"plant_height": settings.height} if settings.height > 0 else {}
    if settings.target == "DIFFERENCE":
        options["max_difference"] = settings.difference
    else:
        options["levels"] = [settings.share ** (k + 1) for k in range(settings.count)]
    window = context.window_manager
    window.progress_begin(0, 100)
    try:
        told = lambda stage, number, of: window.progress_update(100 * number // of if of else 0)  # noqa: E731
        return plant.levels(progress=told, **options)
    except secateur.Error as error:
        raise Failure(str(error)) from error
    finally:
        window.progress_end()


def collection_of(name, parent):
    """An empty collection of this name below another one."""
    known = bpy.data.collections.get(name)
    if known:
        for child in list(known.children):
            for it in list(child.objects):
                bpy.data.objects.remove(it)
            bpy.data.collections.remove(child)
        return known
    made = bpy.data.collections.new(name)
    parent.children.link(made)
    return made


def put_into_scene(context, levels, name):
    """A collection for each level, the finest shown; each knows from how many metres on it is drawn."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, f"{name}.glb")
        levels.write(path, "siblings")
        found = imported(path)
    place = collection_of(LEVELS.format(name), context.scene.collection)
    for number, facts in enumerate(levels.report):
        collection = bpy.data.collections.new(f"{name}_LOD{number}")
        collection["begin_m"] = facts["distance"]
        collection["triangles"] = facts["triangles"]
        collection["difference"] = facts["difference"]
        place.children.link(collection)
        root = next(it for it in found if it.name.split(".")[0] == f"{name}_LOD{number}")
        for it in [root, *root.children_recursive]:
            for other in list(it.users_collection):
                other.objects.unlink(it)
            collection.objects.link(it)
        collection.hide_viewport = collection.hide_render = number > 0
    return place


class _Operator(bpy.types.Operator):
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT"

    def execute(self, context):
        try:
            self.report({"INFO"}, self.work(context))
        except Failure as failure:
            self.report({"ERROR"}, str(failure))
            return {"CANCELLED"}
        return {"FINISHED"}


class FindLeaves(_Operator):
    """Say what is taken for leaves of the selected objects"""

    bl_idname = "secateur.find"
    bl_label = "Find leaves"

    def work(self, context):
        plant, name = plant_of(context)
        parts = [it for it in plant.inspection["primitives"] if it["taken_for"] == "foliage"]
        names = sorted({it.get("material") or "no material" for it in parts})
        said = f"{name}: {plant.leaf_count} leaves, {plant.triangle_count} triangles"
        context.scene.secateur.found = f"{said}; leaves: {', '.join(names)}" if names else said
        return context.scene.secateur.found


class MakeLevels(_Operator):
    """Make levels of the selected objects, a collection for each"""

    bl_idname = "secateur.levels"
    bl_label = "Make levels"

    def work(self, context):
        plant, name = plant_of(context)
        levels = levels_of(context, plant)
        place = put_into_scene(context, levels, name)
        counts = ", ".join(str(it["triangles"]) for it in levels.report)
        return f"{place.name}: {counts} triangles"


class ExportLevels(_Operator):
    """Make levels of the selected objects, and write them for an engine"""

    bl_idname = "secateur.export"
    bl_label = "Export levels"

    def work(self, context):
        settings = context.scene.secateur
        if not settings.folder:
            raise Failure("Name a folder for the levels")
        plant, name = plant_of(context)
        levels = levels_of(context, plant)
        folder = bpy.path.abspath(settings.folder)
        os.makedirs(folder, exist_ok=True)
        ending = {"files": "", "usd": f"{name}.usda"}.get(settings.layout, f"{name}.glb")
        try:
            files = levels.write(os.path.join(folder, ending), settings.layout, overwrite=True)
        except secateur.Error as error:
            raise Failure(str(error)) from error
        return f"{len(files)} files in {folder}"


class SecateurSettings(bpy.types.PropertyGroup):
    """What the panel asks for."""

    name: StringProperty(name="Name", description="What levels are called; the first object's name where it is empty")
    leaves: StringProperty(
        name="Leaves",
        description="Materials of leaves, such as leaf_*, with commas between; where it is empty, what looks like leaves",
    )
    found: StringProperty(name="Found")
    height: FloatProperty(name="Height", description="How high the plant really is; 0: as it is", min=0, unit="LENGTH")
    target: EnumProperty(
        name="Target",
        items=[
            ("DIFFERENCE", "Difference", "Each level as light as it may be where it begins to be seen"),
            ("SHARE", "Triangles", "Each level has a share of the triangles of the one before"),
        ],
    )
    difference: FloatProperty(
        name="Largest difference",
        description="0.18 cannot be told at its size, 0.28 is good, 0.50 is coarse",
        default=0.28,
        min=0.01,
        max=2,
    )
    share: FloatProperty(name="Share", default=0.4, min=0.01, max=0.99)
    count: IntProperty(name="Levels", default=3, min=1, max=7)
    folder: StringProperty(name="Folder", subtype="DIR_PATH")
    layout: EnumProperty(
        name="Files",
        items=[
            ("files", "One each", "A .glb for each level"),
            ("siblings", "One", "One .glb with all levels side by side"),
            ("msft", "MSFT_lod", "One .glb with the extension MSFT_lod"),
            ("usd", "USD", "A .usda with LODRootAPI"),
        ],
    )


class SECATEUR_PT_panel(bpy.types.Panel):
    """Levels of detail of plants"""

    bl_label = "Levels of a plant"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "secateur"

    def draw(self, context):
        settings = context.scene.secateur
        layout = self.layout
        layout.use_property_split = True
        layout.prop(settings, "name")
        layout.prop(settings, "leaves")
        layout.operator("secateur.find", icon="VIEWZOOM")
        if settings.found:
            for line in settings.found.split("; "):
                layout.label(text=line)
        layout.separator()
        layout.prop(settings, "target")
        if settings.target == "DIFFERENCE":
            layout.prop(settings, "difference")
        else:
            layout.prop(settings, "share")
            layout.prop(settings, "count")
        layout.prop(settings, "height")
        layout.operator("secateur.levels", icon="MOD_DECIM")
        layout.separator()
        layout.prop(settings, "folder")
        layout.prop(settings, "layout")
        layout.operator("secateur.export", icon="EXPORT")


CLASSES = [SecateurSettings, FindLeaves, MakeLevels, ExportLevels, SECATEUR_PT_panel]


def register():
    for it in CLASSES:
        bpy.utils.register_class(it)
    bpy.types.Scene.secateur = PointerProperty(type=SecateurSettings)


def unregister():
    del bpy.types.Scene.secateur
    for it in reversed(CLASSES):
        bpy.utils.unregister_class(it)
