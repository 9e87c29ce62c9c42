"""TangiPaint: photographs of a painting under many lights in, a relightable digital twin out.

    import tangipaint
    painting, report = tangipaint.fit(tangipaint.Stack("photographs"))
    raking = tangipaint.relight(painting, [(-1, 0.2, 0.3)], cast_shadows=True)

Frame: x right, y up, z towards the viewer, origin at the centre of the picture; rows of arrays run downwards.
Lengths are in mm, colours linear Rec. 709. Maps are numpy arrays that look into the painting, without copies.
"""
from ._tangipaint import (
    Cancelled,
    Canvas,
    ContractError,
    Error,
    Light,
    Painting,
    Stack,
    __version__,
    calibrate,
    compare,
    fit,
    generate,
    open,
    paints,
    relight,
    save_picture,
    set_threads,
)


class PoorNumbers(UserWarning):
    """A result that is to be used with care: its report says why. warnings.simplefilter("error", PoorNumbers) raises it."""


__all__ = [
    "Cancelled",
    "Canvas",
    "ContractError",
    "Error",
    "Light",
    "Painting",
    "PoorNumbers",
    "Stack",
    "__version__",
    "calibrate",
    "compare",
    "fit",
    "generate",
    "open",
    "paints",
    "relight",
    "save_picture",
    "set_threads",
]
