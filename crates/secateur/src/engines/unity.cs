// Makes a prefab with a LOD Group of the levels in the file beside the folder of this script, whenever it is imported.
// Written by secateur for Unity 2021.3 and later, with any importer of glTF that keeps the names of nodes.
using System.Collections.Generic;
using System.IO;
using UnityEditor;
using UnityEngine;

public class @IDENT@Lods : AssetPostprocessor
{
    const string File = @FILE@;

    // The node of each level, the least share of the screen's height at which it is drawn, and over which share of its
    // heights it fades into the next.
    static readonly (string node, float height, float fade)[] Levels =
    {
@LEVELS@
    };

    static void OnPostprocessAllAssets(string[] imported, string[] deleted, string[] moved, string[] movedFrom)
    {
        foreach (string path in imported)
        {
            if (Path.GetFileName(path) == File)
            {
                EditorApplication.delayCall += () => MakePrefab(path);
            }
        }
    }

    static void MakePrefab(string path)
    {
        GameObject model = AssetDatabase.LoadAssetAtPath<GameObject>(path);
        if (model == null)
        {
            Debug.LogError(path + " was not imported as a model: install an importer of glTF");
            return;
        }
        GameObject root = (GameObject)PrefabUtility.InstantiatePrefab(model);
        try
        {
            List<LOD> lods = new List<LOD>();
            foreach ((string node, float height, float fade) in Levels)
            {
                Transform level = Find(root.transform, node);
                if (level == null)
                {
                    Debug.LogError(path + " has no node " + node);
                    return;
                }
                LOD lod = new LOD(height, level.GetComponentsInChildren<Renderer>(true));
                lod.fadeTransitionWidth = fade;
                lods.Add(lod);
            }
            LODGroup group = root.AddComponent<LODGroup>();
            group.fadeMode = LODFadeMode.CrossFade;
            group.SetLODs(lods.ToArray());
            group.RecalculateBounds();
            PrefabUtility.SaveAsPrefabAsset(root, Path.ChangeExtension(path, ".prefab"));
        }
        finally
        {
            Object.DestroyImmediate(root);
        }
    }

    static Transform Find(Transform from, string name)
    {
        if (from.name == name)
        {
            return from;
        }
        foreach (Transform child in from)
        {
            Transform found = Find(child, name);
            if (found != null)
            {
                return found;
            }
        }
        return null;
    }
}
