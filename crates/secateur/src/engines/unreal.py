"""Makes one static mesh of the levels beside this file, with the screen sizes at which they switch.

Written by secateur for Unreal 5: run it in the editor by Tools > Execute Python Script. It needs the plugins Python
Editor Script Plugin and Interchange, which are on by default.
"""

import os

import unreal

FOLDER = os.path.dirname(os.path.abspath(__file__))
DESTINATION = "/Game/@IDENT@"

# The file of each level, and the screen size from which on it is drawn: the diameter of the bounding sphere as a share
# of the screen's height.
LEVELS = [
@LEVELS@
]


def imported(file):
    """The static mesh in a file."""
    task = unreal.AssetImportTask()
    task.filename = os.path.join(FOLDER, file)
    task.destination_path = DESTINATION + "/" + os.path.splitext(file)[0]
    task.automated = True
    task.replace_existing = True
    task.save = True
    unreal.AssetToolsHelpers.get_asset_tools().import_asset_tasks([task])
    assets = [unreal.load_asset(path) for path in task.imported_object_paths]
    meshes = [asset for asset in assets if isinstance(asset, unreal.StaticMesh)]
    if len(meshes) != 1:
        raise RuntimeError(f"{file} became {len(meshes)} static meshes, not one")
    return meshes[0]


def main():
    editor = unreal.get_editor_subsystem(unreal.StaticMeshEditorSubsystem)
    mesh = imported(LEVELS[0][0])
    for level, (file, _) in enumerate(LEVELS[1:], start=1):
        if editor.set_lod_from_static_mesh(mesh, level, imported(file), 0, True) != level:
            raise RuntimeError(f"{file} did not become level {level}")
    if not editor.set_lod_screen_sizes(mesh, [size for _, size in LEVELS]):
        raise RuntimeError("the screen sizes were not taken")
    unreal.EditorAssetLibrary.save_loaded_asset(mesh)


main()
