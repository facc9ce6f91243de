"""Levels of detail of trees and other plants in glTF.

Lengths are in units of the file, metres as a rule. Arrays are C-contiguous; what is given back is the caller's own.
Nothing holds Python's lock while it computes, so plants can be simplified in threads.

Options of levels are those of the program ``secateur``, with ``_`` for ``-``: ``max_difference=0.18`` is
``--max-difference 0.18``. Names, defaults and bytes are the program's; ``secateur simplify --help`` and
``secateur lods --help`` say what each is.
"""

import os
from collections.abc import Callable, Sequence
from typing import Any, Literal, Protocol, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

__version__: str

class Error(Exception):
    """Anything that secateur refuses. The message is one sentence: what is wrong, and what to do."""

class InputError(Error, ValueError):
    """The input does not allow it: a file is not what it should be, or cannot become what is asked for."""

class UsageError(Error, ValueError):
    """It was asked for wrongly: a keyword is unknown, a value out of its range, an array of the wrong shape."""

class MachineError(Error, RuntimeError):
    """The machine does not allow it: memory, disk, GPU."""

class Cancelled(Error):
    """The event given as ``cancel`` was set; nothing was written."""

class Event(Protocol):
    """What can end work from another thread, such as ``threading.Event``."""

    def is_set(self) -> bool: ...

Progress = Callable[[str, int, int | None], object]
"""Called as ``progress(stage, done, of)``, twenty times a second at most; ``of`` is None where it is not known.
What it raises ends the work and comes out of the call, and so does Ctrl-C."""

_ViewsName = Literal["dodecahedron", "icosahedron", "32", "60", "92", "8", "6"]
_Share = int | float
_Path = str | os.PathLike[str]

class _CommonOptions(TypedDict, total=False):
    alpha: Literal["mask", "ignore"]
    """Whether holes of leaf textures count."""
    sides: Literal["material", "both"]
    """From which sides leaves are seen."""
    engine: Literal["auto", "gpu", "cpu"]
    """Where to rasterise; results are the same, bit for bit."""
    effort: Literal["fast", "normal", "best"]
    """How much work goes into what other options leave to the program."""
    scene: _Path
    """A glTF scene whose cameras are looked from and whose meshes hide leaves."""
    occluder: _Path | Sequence[_Path]
    """Further files of what hides leaves."""

class _LevelOptions(_CommonOptions, total=False):
    triangles: _Share
    """Target: triangles of the whole plant, as a number (int) or a share from 0 to 1 (float)."""
    leaves: int
    """Target: a number of leaves."""
    ratio: float
    """Target: a share of the leaves, 0 to 1."""
    max_error: float
    """Target: the largest VMI error on the driving views, in per cent."""
    wood: Literal["auto", "keep", "ignore", "vmi", "geometry"]
    preset: str
    method: Literal["vds", "vds-reference", "fsa", "stochastic", "meshopt", "chain", "merge"]
    views: str
    """A set of views by its name, or a JSON file of cameras."""
    field_of_view: float | Literal["tight"]
    """In degrees."""
    resolution: int | Literal["auto"]
    """Width and height of driving images in pixels, 1 to 2048."""
    fit: float | Literal["auto", "none", "coverage"]
    cutoffs: Literal["fit", "fit-with-mips", "keep"]
    colors: Literal["dilate", "keep"]
    reference: Literal["original", "previous"]
    resize: str
    neighbours: int
    max_coverage: float | Literal["none"]
    ties: Literal["order", "spread"]
    leaf_triangles: int | Literal["auto", "keep"]
    needles: Literal["widen", "scale"]
    seed: int
    audit: bool

class _LevelsOptions(_CommonOptions, total=False):
    distances: Sequence[float]
    """Distances in metres from which levels are seen, the nearest first."""
    levels: Sequence[float]
    """Levels as shares of all triangles, the finest first."""
    triangles: Sequence[int]
    """Levels as numbers of triangles, the finest first."""
    max_difference: float
    """The largest difference of a level where it begins to be seen: .18 cannot be told, .28 is good, .50 coarse."""
    max_pop: float
    """The largest difference that a switch may show."""
    morph: bool
    """Nests levels, and writes where each vertex goes on the way to the next mesh."""
    impostor: Literal["none", "crossed", "cards", "octahedral", "auto"]
    impostor_textures: str
    """What textures of all impostors together may take on the GPU, such as ``4M``."""
    cost: str
    """What parts of a level count for, such as ``triangle=1,draw=50,disk-kib=0.02,gpu-kib=0.1``."""
    plant_height: float
    """How high the plant really is, in metres."""
    no_original: bool
    """Leaves out the plant itself, which is else the level from 0 m on."""
    shadow_steps: int
    wood: Literal["auto", "keep", "vmi", "geometry"]
    textures: Literal["fit", "keep"]
    preset: Literal["look", "information"]
    screen_height: float
    """In pixels."""
    fov: float
    """The vertical field of view in degrees."""

class LeafArrays(TypedDict):
    """Leaves in world space; every triangle has corners of its own."""

    positions: NDArray[np.float32]
    """(3 m, 3)"""
    triangles: NDArray[np.uint32]
    """(m, 3), rows of ``positions``"""
    leaf_ids: NDArray[np.uint32]
    """(m,), from 1, in the order of the file"""
    uv: NDArray[np.float32]
    """(3 m, 2), v downwards as in glTF"""

class Observation:
    """What views around the plant show of its leaves, counted in integers: the same on every machine."""

    @property
    def areas(self) -> NDArray[np.uint32]:
        """(views, leaves + 1): pixels in which each leaf is frontmost; column 0 is the background."""
    @property
    def areas_sha256(self) -> str:
        """SHA-256 of the areas, as reports of the program have it."""
    @property
    def vmi_bits(self) -> NDArray[np.float64]:
        """(views,): viewpoint mutual information of each view in bits."""
    @property
    def eyes(self) -> NDArray[np.float64]:
        """(views, 3): where the views stand, in world space."""
    @property
    def leaf_ids(self) -> NDArray[np.uint32] | None:
        """(views, height, width): the leaf in each pixel, rows from the top, 0 for the background; None unless asked
        for."""
    def vmi_error_percent(self, other: Observation) -> float:
        """The VMI error of another observation against this one of the original, in per cent."""

class Plant:
    """A plant whose leaves and wood are known."""

    @property
    def leaf_count(self) -> int: ...
    @property
    def triangle_count(self) -> int:
        """Triangles of leaves and wood."""
    @property
    def wood_triangle_count(self) -> int: ...
    @property
    def inspection(self) -> dict[str, Any]:
        """What was taken for leaves, and why, as ``secateur inspect --format json`` has it."""
    def level(
        self,
        *,
        progress: Progress | None = None,
        cancel: Event | None = None,
        **options: Unpack[_LevelOptions],
    ) -> Level:
        """One level to a target: what ``secateur simplify`` writes. One of ``triangles``, ``leaves``, ``ratio`` and
        ``max_error`` must be given."""
    def levels(
        self,
        *,
        progress: Progress | None = None,
        cancel: Event | None = None,
        **options: Unpack[_LevelsOptions],
    ) -> Levels:
        """Levels for an engine, each as light as ``max_difference`` lets it be: what ``secateur lods`` writes."""
    def leaf_arrays(self) -> LeafArrays: ...
    def observe(
        self,
        views: _ViewsName = "dodecahedron",
        resolution: int = 256,
        *,
        alpha: Literal["mask", "ignore"] = "mask",
        sides: Literal["material", "both"] = "material",
        leaf_ids: bool = False,
    ) -> Observation:
        """Draws the leaves in views of ``resolution`` x ``resolution`` pixels and counts."""

class Level:
    """A plant made lighter, with the material changes that belong to it."""

    @property
    def report(self) -> dict[str, Any]:
        """Its figures by the keys of the program's reports: ``leaves``, ``triangles``, ``order_sha256``,
        ``areas_sha256``, ``vmi_bits``, ``difference`` at 128 pixels, and others."""
    @property
    def leaf_count(self) -> int: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def removal_order(self) -> NDArray[np.uint32]:
        """(steps,): the leaves that went, first to last. Numbers above those of the plant are leaves that were made
        of others."""
    @property
    def areas(self) -> NDArray[np.uint32] | None:
        """(views, leaves + 1): pixels of each leaf in the driving views; None of methods that see none."""
    def leaf_arrays(self) -> LeafArrays:
        """The leaves that are left, in their sizes; numbered anew from 1."""
    def observe(
        self,
        views: _ViewsName = "dodecahedron",
        resolution: int = 256,
        *,
        alpha: Literal["mask", "ignore"] = "mask",
        sides: Literal["material", "both"] = "material",
        leaf_ids: bool = False,
    ) -> Observation:
        """As ``Plant.observe``, from the same places. Columns and numbers are those of the plant's leaves, or, where
        leaves were made of others, those of ``leaf_arrays``."""
    def to_bytes(self) -> bytes:
        """The level as a GLB."""
    def write(self, path: _Path, *, overwrite: bool = False) -> list[os.PathLike[str]]:
        """Writes a .glb or .gltf, whole or not at all; gives the files, those beside it included."""

class Levels:
    """Levels of a plant, finest first."""

    def __len__(self) -> int: ...
    @property
    def name(self) -> str:
        """What files and nodes are called after."""
    @property
    def notes(self) -> list[str]:
        """What was asked for and left out, and the like, a sentence each."""
    @property
    def report(self) -> list[dict[str, Any]]:
        """The figures of each level by the keys of the program's reports: ``kind``, ``triangles``, ``distance`` in
        metres, ``screen_coverage``, ``difference`` and others."""
    def to_bytes(self, layout: Literal["files", "siblings", "msft", "usd"] = "files") -> dict[str, bytes]:
        """The files by their names."""
    def write(
        self,
        path: _Path,
        layout: Literal["files", "siblings", "msft", "usd"] | None = None,
        *,
        overwrite: bool = False,
    ) -> list[os.PathLike[str]]:
        """Writes the levels into a folder, or into one file if ``path`` ends in .glb, .gltf or .usda; gives the files."""
    def preview_html(self) -> str:
        """A page that shows the levels beside the plant."""

def open(
    source: _Path | bytes,
    *,
    foliage: Sequence[str] | None = None,
    not_plant: Sequence[str] | None = None,
    vertex_alpha: Literal["auto", "keep", "ignore"] = "auto",
    wind: bool = False,
    memory: str = "auto",
    name: str = "plant.glb",
) -> Plant:
    """Opens a .glb or .gltf, or the bytes of a .glb, which errors and levels call ``name``.

    ``foliage`` names what is foliage, such as ``["material:leaf_*"]``; without it the evidence shows it. ``not_plant`` names
    likewise what stays as it is, beside ground and helpers. With ``wind`` vertices say what they hang on, in the
    attributes of docs/wind.md. ``memory`` is
    the most that the plant and its levels may take, such as ``"2G"``."""

def grow(species: str, leaves: int | None = None, seed: int = 1) -> Plant:
    """Grows a plant: oak, carya, birch, alder, maple, rowan, pine, palmetto, willow or bush. It has the bytes that
    ``secateur grow`` writes."""

def judge(
    plant: Plant | _Path | bytes,
    other: Level | Plant | _Path | bytes,
    *,
    pixels_high: Sequence[float] = (540.0,),
) -> dict[str, Any]:
    """Judges another file of a plant from views that no simplifier sees, by the keys of ``secateur measure --format
    json``: ``difference`` (the worst of ``differences`` at these heights on the screen), ``vmi_error_percent``,
    ``silhouette_iou``, ``ssim`` and others."""

def from_arrays(
    positions: NDArray[np.float32],
    triangles: NDArray[np.uint32],
    leaf_ids: NDArray[np.uint32],
    *,
    uv: NDArray[np.float32] | None = None,
    mask: NDArray[np.uint8] | None = None,
    cutoff: float = 0.5,
) -> Plant:
    """A plant of arrays: ``positions`` (n, 3), y upwards; ``triangles`` (m, 3), rows of ``positions``; ``leaf_ids``
    (m,), 0 for wood. A leaf's triangles hang together by edges, and two leaves share none. Leaves are seen from both
    sides.

    ``uv`` (n, 2) with v downwards and ``mask`` (height, width), alpha from 0 to 255, cut leaves out where alpha is below
    ``cutoff`` (0 to 1)."""
