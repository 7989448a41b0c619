// SPDX-License-Identifier: AGPL-3.0-or-later
// The mdf blocks of an object. relief.cpp looks how steep the bumps of those with `horizon mutual`
// are.
#ifndef POVRAY_BACKEND_MDF_RELIEF_H
#define POVRAY_BACKEND_MDF_RELIEF_H

#include <set>

#include "backend/frame.h"

namespace pov {

// All finishes with an mdf block of an object's textures; of a compound one's parts, too, where
// asked for.
typedef std::set<const FINISH *> MdfBlocks;
void Collect_Mdf_Blocks(const ObjectBase *object, bool parts, MdfBlocks &blocks);

} // namespace pov

#endif
