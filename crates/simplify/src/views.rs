//! Where a foliage is looked at from while it is simplified.

use glam::DQuat;
use secateur_model::{BoundingSphere, Foliage};
use secateur_raster::ViewSet;

use serde::{Deserialize, Serialize};

use crate::Error;
use crate::vds::ViewPlan;

/// Where the foliage is looked at from while it is simplified. Built-in sets are spelled by their
/// names; cameras of one's own have none, and do not come back from their spelling.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Views {
    /// [`Self::Dodecahedron`], or with a budget of triangles [`Self::Dodecahedra`] where most of the visible
    /// leaves cover at most a pixel in every one of the former's views. Until a run has looked, the former.
    #[default]
    Auto,
    /// The 20 vertices of a dodecahedron, at 3 radii from the foliage's centre.
    Dodecahedron,
    /// The 12 vertices of an icosahedron; not of one that judges.
    Icosahedron,
    /// 32 views: those of the dodecahedron, and the icosahedron that judges nothing.
    Both,
    /// 60 views: the dodecahedron and two turned ones.
    Dodecahedra,
    /// The dodecahedron and three turned ones, 20 views at a time: see [`ViewPlan::turning`].
    Turning,
    /// 92 views all around, those of the dodecahedron among them. One of the sets that judge stands
    /// among them too.
    Geodesic,
    /// The 8 corners of a cube.
    Cube,
    /// The 6 corners of an octahedron.
    Octahedron,
    /// The paper's variable number: 20 views up to 10 % simplification, 12 to
    /// 30 %, 8 to 50 %, then 6.
    Variable,
    /// Cameras that the caller has placed.
    Cameras(ViewSet),
    /// Others, turned as one about the foliage's centre, and with them those in which sizes
    /// are fitted.
    Turned {
        /// The views before they are turned.
        views: Box<Self>,
        /// The rotation, about the centre of the foliage's bounding sphere.
        turn: DQuat,
    },
}

impl Views {
    /// The name in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Dodecahedron => "dodecahedron",
            Self::Icosahedron => "icosahedron",
            Self::Both => "32",
            Self::Dodecahedra => "60",
            Self::Turning => "turning",
            Self::Geodesic => "92",
            Self::Cube => "8",
            Self::Octahedron => "6",
            Self::Variable => "vnc",
            Self::Cameras(_) => "cameras",
            Self::Turned { .. } => "turned",
        }
    }

    /// The built-in set that goes by a name or by its number of views.
    pub fn by_name(name: &str) -> Option<Self> {
        Some(match name {
            "auto" => Self::Auto,
            "dodecahedron" | "20" => Self::Dodecahedron,
            "icosahedron" | "12" => Self::Icosahedron,
            "32" => Self::Both,
            "60" => Self::Dodecahedra,
            "turning" => Self::Turning,
            "92" => Self::Geodesic,
            "cube" | "8" => Self::Cube,
            "octahedron" | "6" => Self::Octahedron,
            "vnc" => Self::Variable,
            _ => return None,
        })
    }

    /// The cameras about a foliage with this bounding sphere; the first set where there are
    /// several, one after the other.
    pub fn around(&self, sphere: BoundingSphere) -> ViewSet {
        self.plan(sphere).first()
    }

    /// All sets that a run looks from, one after the other.
    pub fn driving(&self, sphere: BoundingSphere) -> Vec<ViewSet> {
        self.plan(sphere).sets()
    }

    /// Whether the caller has placed the cameras.
    pub(crate) fn are_cameras(&self) -> bool {
        matches!(self.unturned(), Self::Cameras(_))
    }

    /// Whether a run decides which they are.
    pub(crate) fn are_auto(&self) -> bool {
        matches!(self.unturned(), Self::Auto)
    }

    /// These views as they are before they are turned.
    fn unturned(&self) -> &Self {
        let mut views = self;
        while let Self::Turned { views: own, .. } = views {
            views = own;
        }
        views
    }

    /// These views, or those that were decided where a run decides.
    pub(crate) fn instead_of_auto(&self, decided: &Self) -> Self {
        match self {
            Self::Auto => decided.clone(),
            Self::Turned { views, turn } => Self::Turned {
                views: Box::new(views.instead_of_auto(decided)),
                turn: *turn,
            },
            own => own.clone(),
        }
    }

    pub(crate) fn plan(&self, sphere: BoundingSphere) -> ViewPlan {
        ViewPlan::Fixed(match self {
            Self::Variable => return ViewPlan::variable(sphere),
            Self::Turning => return ViewPlan::turning(sphere),
            Self::Turned { views, turn } => {
                let plan = views.plan(sphere);
                return plan.map(|set| set.turned(sphere.centre, *turn));
            }
            Self::Auto | Self::Dodecahedron => ViewSet::dodecahedron(sphere),
            Self::Icosahedron => ViewSet::driving_icosahedron(sphere),
            Self::Both => {
                let icosahedron = ViewSet::driving_icosahedron(sphere);
                ViewSet::dodecahedron(sphere).followed_by(&[icosahedron])
            }
            Self::Dodecahedra => {
                let [a, b, _] = ViewSet::turned_dodecahedra(sphere);
                ViewSet::dodecahedron(sphere).followed_by(&[a, b])
            }
            Self::Geodesic => ViewSet::geodesic(sphere),
            Self::Cube => ViewSet::cube(sphere),
            Self::Octahedron => ViewSet::octahedron(sphere),
            Self::Cameras(views) => views.clone(),
        })
    }
}

impl TryFrom<String> for Views {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::by_name(&name).ok_or_else(|| format!("{name} is no set of views"))
    }
}

impl From<Views> for String {
    fn from(views: Views) -> Self {
        views.name().to_owned()
    }
}

/// The bounding sphere, if cameras about it can be computed.
///
/// # Errors
/// [`Error::NoLeaf`] or [`Error::OutOfRange`].
pub fn sphere_of(foliage: &Foliage) -> Result<BoundingSphere, Error> {
    let sphere = foliage.bounding_sphere().ok_or(Error::NoLeaf)?;
    // A foliage without extent is looked at as if it had a radius of 1.
    let size = if sphere.radius > 0.0 {
        sphere.radius
    } else {
        1.0
    };
    let distance = sphere.centre.length();
    let is_in_range = (1e-30..=1e30).contains(&size) && distance <= 1e9 * size;
    is_in_range.then_some(sphere).ok_or(Error::OutOfRange {
        radius: sphere.radius,
        distance,
    })
}
