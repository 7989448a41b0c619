// SPDX-License-Identifier: AGPL-3.0-or-later

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"
#include "backend/mdf/dumptask.h"

#include <stdexcept>

#include "backend/control/messagefactory.h"
#include "backend/mdf/dump.h"
#include "backend/mdf/material.h"
#include "backend/scene/scene.h"
#include "backend/scene/view.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

void View::StartMdfDump(unsigned int &tracing_method) {
  const std::string path = mdf::Dump::wanted();
  SceneData &scene = *viewData.sceneData;
  const vector<LightSource *> &lights = scene.lightSources;
  MessageFactory messages(10, 370, "Render", scene.backendAddress, scene.frontendAddress,
                          scene.sceneId, viewData.viewId);

  if (path.empty())
    return;
  if (tracing_method != 0)
    messages.Warning(0,
                     "LIBSHADE_DUMP: a dump holds one ray a pixel; anti-aliasing is switched off.");
  tracing_method = 0;
  if (viewData.camera.Aperture != 0.0)
    messages.Warning(0, "LIBSHADE_DUMP: a dump holds one ray a pixel; focal blur is switched off.");
  viewData.camera.Aperture = 0.0;
  for (size_t i = 0; i < lights.size(); i++)
    if (lights[i]->Area_Light && lights[i]->Use_Full_Area_Lighting)
      messages.Warning(0,
                       "LIBSHADE_DUMP: light %d has area_illumination, many directions at once; it "
                       "is left out of the dump.",
                       (int)i);

  try {
    viewData.mdfDump.reset(new mdf::Dump(
        path, (int)viewData.width, (int)viewData.height,
        (int)(lights.size() + scene.lightGroupLightSources.size()), scene.mdfScene->has_cloth(),
        scene.mdfScene->has_painted(), scene.mdfScene->has_bumps(), scene.mdfScene->has_scratches(),
        scene.mdfScene->has_reliefs()));
  } catch (const std::runtime_error &e) {
    throw POV_EXCEPTION_STRING(e.what());
  }
}

void MdfDumpTask::Run() {
  // not POV_RAY_VERSION: the distribution's own suffix says nothing about the shading
  GetViewData()->GetMdfDump()->write(
      GetSceneData()->mdfScene->json("POV-Ray " VERSION " + libshade"));
}

void MdfDumpTask::Finish() {
  GetViewDataPtr()->timeType = SceneThreadData::kRenderTime;
  GetViewDataPtr()->realTime = ConsumedRealTime();
  GetViewDataPtr()->cpuTime = ConsumedCPUTime();
}

} // namespace pov
