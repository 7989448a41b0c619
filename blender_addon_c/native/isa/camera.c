/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/camera.h"
#include "stage/film.h"

STAGES(camera) = {
    .camera = stage_camera,
    .lens = stage_lens,
    .film = stage_film,
};
