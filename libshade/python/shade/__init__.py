# SPDX-License-Identifier: Apache-2.0
"""libshade from Python: what the shared library reflects, over numpy arrays. docs/library/python.md has examples.

    metal = shade.Material(mdf="ggx", ax=.1, ay=.4)
    f, cosine = shade.eval(metal, n, wi, wo)

Directions are in the local frame of the shaded point: x the tangent, z the unperturbed normal, y = z × x; wi to the
light, wo to the eye, n the perturbed normal, all unit, arrays whose last axis is 3. Arrays are broadcast against each
other. Where every numpy array given is float32 (or shorter) so is the result, and the float kernels ran; else it is
float64. Calls hold no state and let other threads of Python run.
"""
from ._arrays import Status
from ._cloth import Fabric, fabric, presets, weaves
from ._library import PATH as library
from ._maps import Relief, Scratches, SlopeMap, split
from ._material import D, Material, choices, eval, isa, lists, metals, parameters, pdf, sample

__all__ = ["D", "Fabric", "Material", "Relief", "Scratches", "SlopeMap", "Status", "choices", "eval", "fabric", "isa", "library",
           "lists", "metals", "parameters", "pdf", "presets", "sample", "split", "weaves"]
