// SPDX-License-Identifier: AGPL-3.0-or-later
// The dump's begin (View::StartMdfDump) and end in a render.
#ifndef POVRAY_BACKEND_MDF_DUMPTASK_H
#define POVRAY_BACKEND_MDF_DUMPTASK_H

#include "backend/render/rendertask.h"

namespace pov {

// Writes the dump once the picture is complete. A task, so that a failure ends
// the render with an error.
class MdfDumpTask : public RenderTask {
public:
  MdfDumpTask(ViewData *view) : RenderTask(view) {}

protected:
  void Run();
  void Stopped() {}
  void Finish();
};

} // namespace pov

#endif
