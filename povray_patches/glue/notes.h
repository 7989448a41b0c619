// SPDX-License-Identifier: AGPL-3.0-or-later
// `notes on`: a block told in words.
#ifndef POVRAY_BACKEND_MDF_NOTES_H
#define POVRAY_BACKEND_MDF_NOTES_H

#include <string>

#include "backend/frame.h"
#include "backend/mdf/material.h"

namespace pov {

// What the block of this finish is, and what of the finish adds to it: lines, each with its end.
// The finish must have a block.
std::string Mdf_Notes(const FINISH *finish);

// How steep the bumps of a block are: a line with its end.
std::string Mdf_Slopes_Note(const mdf::Material &material);

} // namespace pov

#endif
