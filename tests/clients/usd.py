"""Opens levels written as USD, and says what a program finds in them, as JSON.

Calls: usd.py FILE.usda FIELD_OF_VIEW_DEGREES DISTANCE_M...
"""

import json
import sys

from pxr import Gf, Usd, UsdGeom, UsdLod, UsdShade, UsdUtils, UsdValidation

path, field_of_view, *distances = sys.argv[1:]
stage = Usd.Stage.Open(path)
validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
errors = UsdValidation.ValidationContext(validators).Validate(stage)
assert not errors, [error.GetErrorAsString() for error in errors]
root = stage.GetDefaultPrim()
lods = [prim for prim in stage.Traverse() if prim.HasAPI(UsdLod.RootAPI)]
assert len(lods) == 1, lods
(target,) = UsdLod.RootAPI(lods[0]).GetLodHeuristicsRel().GetTargets()
heuristic = UsdLod.ScreenSizeHeuristic(stage.GetPrimAtPath(target))
assert heuristic, target

levels = []
for level in lods[0].GetChildren():
    meshes = [UsdGeom.Mesh(prim) for prim in Usd.PrimRange(level) if prim.IsA(UsdGeom.Mesh)]
    thresholds = []
    for mesh in meshes:
        points = mesh.GetPointsAttr().Get()
        corners = mesh.GetFaceVertexIndicesAttr().Get()
        assert max(corners) < len(points) and set(mesh.GetFaceVertexCountsAttr().Get()) == {3}
        assert len(mesh.GetNormalsAttr().Get()) == len(points)
        computed = UsdGeom.PointBased.ComputeExtent(points)
        assert all(Gf.IsClose(a, b, 1e-4) for a, b in zip(computed, mesh.GetExtentAttr().Get()))
        st = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
        assert not st or len(st.Get()) == len(points)
        material, _ = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial()
        shader, *_ = material.ComputeSurfaceSource()
        assert shader.GetIdAttr().Get() == "UsdPreviewSurface"
        threshold = shader.GetInput("opacityThreshold")
        if threshold and threshold.Get() is not None:
            thresholds.append(threshold.Get())
            source = shader.GetInput("opacity").GetConnectedSources()[0][0].source
            assert UsdShade.Shader(source.GetPrim()).GetIdAttr().Get() == "UsdUVTexture"
    levels.append(
        {
            "name": level.GetName(),
            "triangles": sum(len(mesh.GetFaceVertexCountsAttr().Get()) for mesh in meshes),
            "points": sum(len(mesh.GetPointsAttr().Get()) for mesh in meshes),
            "thresholds": thresholds,
            "facts": level.GetCustomDataByKey("secateur"),
        }
    )


def level_at(distance):
    low, high = (Gf.Vec3d(corner) for corner in heuristic.GetExtentAttr().Get())
    frustum = Gf.Frustum()
    frustum.SetPerspective(float(field_of_view), True, 16 / 9, 0.01, 1e6)
    frustum.SetPosition((low + high) / 2 + Gf.Vec3d(0, 0, float(distance)))
    return heuristic.ComputeLOD(frustum, Gf.Matrix4d(1))


variants = root.GetVariantSet("level")
alone = []
for name in variants.GetVariantNames():
    variants.SetVariantSelection(name)
    alone.append([prim.GetName() for prim in lods[0].GetChildren() if prim.IsActive()])
variants.SetVariantSelection("auto")
_, files, missing = UsdUtils.ComputeAllDependencies(path)
assert not missing, missing
report = {
    "up": UsdGeom.GetStageUpAxis(stage),
    "levels": levels,
    "drawn": [level_at(distance) for distance in distances],
    "files": len(files),
    "alone": alone,
}
print(json.dumps(report))
