//! Materials (`UsdPreviewSurface`) and the files of their textures.

use std::collections::HashMap;
use std::fmt::Write as _;

use serde_json::{Value, json};

use super::super::super::plant::png_bytes;
use super::super::ChainFile;
use super::text::{asset, quoted, tuple, unique};
use crate::Document;
use crate::material::base_color_texture;
use crate::surfaces::DrawnSurface;
use secateur_model::{AlphaMode, Material, Texture, Wrap};

/// Materials of all levels, each once, and their textures.
pub(super) struct Looks {
    /// The path of the prim that they are below.
    scope: String,
    /// The folder of the textures, beside the layer.
    folder: String,
    names: Vec<String>,
    /// By its text without its name.
    known: HashMap<String, String>,
    file_names: Vec<String>,
    file_of: HashMap<Vec<u8>, String>,
    /// The layer's text for all materials that were asked for so far.
    pub(super) text: String,
}

impl Looks {
    pub(super) fn new(scope: String, plant: &str) -> Self {
        Self {
            scope,
            folder: format!("{plant}_textures"),
            names: Vec::new(),
            known: HashMap::new(),
            file_names: Vec::new(),
            file_of: HashMap::new(),
            text: String::new(),
        }
    }

    /// The path of the material of a surface.
    pub(super) fn path_of(&mut self, document: &Document, drawn: &DrawnSurface) -> String {
        let material = &drawn.surface.material;
        let fields = drawn.material.and_then(|number| {
            let materials = document.root.get("materials");
            materials.and_then(|all| all.get(number))
        });
        let of = |info: Option<&Value>| info.and_then(|info| image_of(document, info));
        let base = fields.and_then(base_color_texture);
        let color = material.texture.as_deref().map(|texture| {
            let name = format!("{}_color", material.name);
            (self.file(&name, texture, of(base)), texture)
        });
        let normals = material.finish.normal_map.as_ref().map(|map| {
            let name = format!("{}_normal", material.name);
            let image = of(fields.and_then(|fields| fields.get("normalTexture")));
            (self.file(&name, &map.texture, image), map)
        });
        let has_colors = !drawn.surface.colors.is_empty();
        let shaders = |path: &str| {
            let mut text = surface(
                material,
                path,
                color.is_some(),
                normals.is_some(),
                has_colors,
            );
            if let Some((file, texture)) = &color {
                let scale = format!("float4 inputs:scale = {}", tuple(material.base_color));
                text.push_str(&image_shader("Color", path, file, texture, "sRGB", &scale));
            }
            if let Some((file, map)) = &normals {
                let s = map.scale;
                let scale = format!(
                    "float4 inputs:bias = {}\n                float4 inputs:scale = {}",
                    tuple([-s, -s, -1.0, 0.0]),
                    tuple([2.0 * s, 2.0 * s, 2.0, 1.0])
                );
                text.push_str(&image_shader(
                    "Normal",
                    path,
                    file,
                    &map.texture,
                    "raw",
                    &scale,
                ));
            }
            if color.is_some() || normals.is_some() {
                text.push_str(&reader("TextureCoordinates", "float2", "st"));
            } else if has_colors {
                text.push_str(&reader("VertexColor", "float3", "displayColor"));
            }
            text
        };
        let key = format!("{}\n{}", material.name, shaders(""));
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let name = match material.name.is_empty() {
            true => "material",
            false => &material.name,
        };
        let prim = unique(name, &mut self.names);
        let path = format!("{}/{prim}", self.scope);
        let _ = write!(
            self.text,
            "        def Material \"{prim}\" (\n            displayName = {}\n        )\n        {{\n            \
             token outputs:surface.connect = <{path}/Surface.outputs:surface>\n{}        }}\n",
            quoted(name),
            shaders(&path)
        );
        self.known.insert(key, path.clone());
        path
    }

    /// The file of a texture: the image as it is where it is a PNG or a JPEG, else a PNG.
    fn file(&mut self, name: &str, texture: &Texture, image: Option<Vec<u8>>) -> String {
        let kept = image.and_then(|bytes| Some((extension_of(&bytes)?, bytes)));
        let (extension, bytes) = kept.unwrap_or_else(|| ("png", png_bytes(texture)));
        if let Some(known) = self.file_of.get(&bytes) {
            return known.clone();
        }
        let stem = unique(name, &mut self.file_names);
        let file = format!("{}/{stem}.{extension}", self.folder);
        self.file_of.insert(bytes, file.clone());
        file
    }

    /// Bytes of all textures so far.
    pub(super) fn texture_bytes(&self) -> u64 {
        self.file_of.keys().map(|bytes| bytes.len() as u64).sum()
    }

    /// The textures, by their names.
    pub(super) fn into_files(self) -> Vec<ChainFile> {
        let all = self.file_of.into_iter();
        let mut files: Vec<ChainFile> = all
            .map(|(bytes, name)| ChainFile {
                name,
                bytes,
                is_as_it_came: false,
            })
            .collect();
        files.sort_by(|a, b| a.name.cmp(&b.name));
        files
    }
}

/// The bytes of the image that a material names.
fn image_of(document: &Document, info: &Value) -> Option<Vec<u8>> {
    let used = document
        .texture_use(&json!({"index": info.get("index")?}))
        .ok()?;
    document.encoded_image(used.image?)
}

fn extension_of(image: &[u8]) -> Option<&'static str> {
    let begins = [(&b"\x89PNG"[..], "png"), (&b"\xff\xd8\xff"[..], "jpg")];
    let found = begins.iter().find(|(begin, _)| image.starts_with(begin));
    found.map(|(_, extension)| *extension)
}

/// The shader that all others lead to.
fn surface(
    material: &Material,
    path: &str,
    has_texture: bool,
    has_normals: bool,
    has_colors: bool,
) -> String {
    let [r, g, b, alpha] = material.base_color;
    let color = match (has_texture, has_colors) {
        (true, _) => format!(".connect = <{path}/Color.outputs:rgb>"),
        (false, true) => format!(".connect = <{path}/VertexColor.outputs:result>"),
        (false, false) => format!(" = {}", tuple([r, g, b])),
    };
    let opacity = match has_texture {
        true => format!(".connect = <{path}/Color.outputs:a>"),
        false => format!(" = {alpha}"),
    };
    let mut lines = match material.finish.is_unlit {
        true => vec![
            "color3f inputs:diffuseColor = (0, 0, 0)".to_owned(),
            format!("color3f inputs:emissiveColor{color}"),
        ],
        false => vec![format!("color3f inputs:diffuseColor{color}")],
    };
    match material.alpha_mode {
        AlphaMode::Opaque => {}
        AlphaMode::Blend => lines.push(format!("float inputs:opacity{opacity}")),
        AlphaMode::Mask(cutoff) => {
            lines.push(format!("float inputs:opacity{opacity}"));
            lines.push(format!("float inputs:opacityThreshold = {cutoff}"));
        }
    }
    if has_normals {
        lines.push(format!(
            "normal3f inputs:normal.connect = <{path}/Normal.outputs:rgb>"
        ));
    }
    lines.push(format!(
        "float inputs:roughness = {}",
        material.finish.roughness
    ));
    lines.push("float inputs:metallic = 0".to_owned());
    lines.push("token outputs:surface".to_owned());
    shader("Surface", "UsdPreviewSurface", &lines)
}

fn image_shader(
    name: &str,
    path: &str,
    file: &str,
    texture: &Texture,
    space: &str,
    scale: &str,
) -> String {
    let wrap = texture.wrap.map(|wrap| match wrap {
        Wrap::Repeat => "repeat",
        Wrap::ClampToEdge => "clamp",
        Wrap::MirroredRepeat => "mirror",
    });
    let lines = [
        format!("asset inputs:file = {}", asset(file)),
        format!("token inputs:sourceColorSpace = \"{space}\""),
        format!("float2 inputs:st.connect = <{path}/TextureCoordinates.outputs:result>"),
        format!("token inputs:wrapS = \"{}\"", wrap[0]),
        format!("token inputs:wrapT = \"{}\"", wrap[1]),
        scale.to_owned(),
        "float outputs:a".to_owned(),
        "float3 outputs:rgb".to_owned(),
    ];
    shader(name, "UsdUVTexture", &lines)
}

fn reader(name: &str, kind: &str, primvar: &str) -> String {
    let lines = [
        format!("string inputs:varname = \"{primvar}\""),
        format!("{kind} outputs:result"),
    ];
    shader(name, &format!("UsdPrimvarReader_{kind}"), &lines)
}

fn shader(name: &str, id: &str, lines: &[String]) -> String {
    let mut text = format!(
        "            def Shader \"{name}\"\n            {{\n                uniform token info:id = \"{id}\"\n"
    );
    for line in lines {
        let _ = writeln!(text, "                {line}");
    }
    text.push_str("            }\n");
    text
}
