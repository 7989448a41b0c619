/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shade-render: a saved scene's picture and passes, without Blender. */
#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dump/whole.h"
#include "image/image.h"
#include "port/process.h"
#include "render/job.h"
#include "scene_file.h"
#include "share.h"
#include "stage/stage.h"
#include "tool/parse.h"
#include "tool/tool.h"
#include "tool/work.h"

static const char HELP[] =
    "usage: shade-render SCENE -o FILE.exr [options]\n"
    "       shade-render SCENE -o FILE.shshare [--tile X,Y,W,H] [--share A,B] [options]\n"
    "       shade-render SCENE --merge FILE.shshare... -o FILE.exr [options]\n\n"
    "Renders what Blender saved by Save Scene for libshade: the same pixels, without Blender.\n\n"
    "  -o, --output FILE.exr  the picture and its passes, named as in Blender's multilayer files\n"
    "  --samples N            of a pixel, instead of the scene's\n"
    "  --seed N               0 to 4294967295, instead of the scene's\n"
    "  --threads N            1 to 256; else the scene's, or one a processor\n"
    "  --tile X,Y,W,H         this part alone, from the left and the top: a file that knows its "
    "place\n"
    "  --share A,B            of each pixel's samples, numbered from 0, those from A to B - 1\n"
    "                         alone, as sums that --merge adds up: FILE.shshare\n"
    "  --merge                the picture whose tiles and shares are named behind the scene, as "
    "if\n"
    "                         rendered at once; denoised then, if the scene is\n"
    "  --passes A,B           these alone; without: all that the scene has\n"
    "  --progress             how far it is, every two seconds, also where no terminal is\n"
    "  --help, --version\n\n"
    "Exit status: 0 done, 1 bad input, 2 bad usage, 130 after Ctrl-C, which leaves no file.\n";

typedef struct options {
  const char *scene, *output, *passes;
  char **shares; /* of --merge */
  size_t share_count;
  int64_t samples, seed, threads, tile[4], share[2];
  bool has_seed, has_tile, has_share, merge, progress, to_share;
} options;

__attribute__((format(printf, 1, 2))) static int complain(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fputs("shade-render: ", stderr);
  vfprintf(stderr, format, arguments);
  fputc('\n', stderr);
  va_end(arguments);
  return TOOL_BAD_INPUT;
}

/* Whole numbers; those from `positive` on are at least 1. */
static bool parse_list(char *text, int count, int positive, int64_t *value) {
  for (int k = 0; k < count; k++) {
    char *comma = strchr(text, ',');
    if (!comma != (k == count - 1))
      return false;
    if (comma)
      *comma = 0;
    if (!tool_parse_whole(text, k < positive ? 0 : 1, SHADE_IMAGE_MAX_SIDE, &value[k]))
      return false;
    text = comma ? comma + 1 : text;
  }
  return true;
}

static bool ends_with(const char *text, const char *end) {
  return strlen(text) > strlen(end) && strcmp(text + strlen(text) - strlen(end), end) == 0;
}

/* What is not among the options: the scene, and shares where these are merged. */
static int parse_names(int argc, char **argv, options *o) {
  const char *wrong = NULL;
  o->to_share = o->output && ends_with(o->output, ".shshare");
  o->share_count = o->merge && argc > optind ? (size_t)(argc - optind - 1) : 0;
  o->shares = argv + optind + 1;
  if (argc - optind != 1 + (int)o->share_count || !o->output ||
      (!o->to_share && shade_image_format_of(o->output) != SHADE_IMAGE_EXR))
    wrong = "one scene and -o FILE.exr are expected";
  else if (o->merge && (!o->share_count || o->has_tile || o->has_share || o->to_share ||
                        o->samples || o->has_seed))
    wrong = "--merge expects one FILE.shshare or more, and takes samples and seed from these";
  else if (o->has_share && !o->to_share)
    wrong = "--share expects -o FILE.shshare";
  else if (o->to_share && o->passes)
    wrong = "a share has all passes: --passes goes with --merge";
  if (!wrong) {
    o->scene = argv[optind];
    return TOOL_DONE;
  }
  fprintf(stderr, "shade-render: %s; see --help\n", wrong);
  return TOOL_BAD_USAGE;
}

/* TOOL_DONE where there is something to render, and -1 where all is said. */
static int parse(int argc, char **argv, options *o) {
  static const struct option words[] = {
      {"output", 1, 0, 'o'},   {"samples", 1, 0, 'n'}, {"seed", 1, 0, 's'},
      {"threads", 1, 0, 't'},  {"tile", 1, 0, 'r'},    {"passes", 1, 0, 'p'},
      {"progress", 0, 0, 'v'}, {"help", 0, 0, 'h'},    {"version", 0, 0, 'V'},
      {"share", 1, 0, 'k'},    {"merge", 0, 0, 'm'},   {0}};
  for (int word; (word = getopt_long(argc, argv, "o:h", words, NULL)) != -1;) {
    bool good = true;
    switch (word) {
    case 'o':
      o->output = optarg;
      break;
    case 'n':
      good = tool_parse_whole(optarg, 1, 1 << 16, &o->samples);
      break;
    case 's':
      o->has_seed = good = tool_parse_whole(optarg, 0, UINT32_MAX, &o->seed);
      break;
    case 't':
      good = tool_parse_whole(optarg, 1, TOOL_MAX_THREADS, &o->threads);
      break;
    case 'r':
      o->has_tile = good = parse_list(optarg, 4, 2, o->tile);
      break;
    case 'k':
      o->has_share = good = parse_list(optarg, 2, 1, o->share) && o->share[0] < o->share[1];
      break;
    case 'm':
      o->merge = true;
      break;
    case 'p':
      o->passes = optarg;
      break;
    case 'v':
      o->progress = true;
      break;
    case 'h':
      return fputs(HELP, stdout) < 0 ? TOOL_BAD_INPUT : -1;
    case 'V':
      return printf("shade-render %s (%s)\n", SHADE_VERSION, stages_choose()->name) < 0
                 ? TOOL_BAD_INPUT
                 : -1;
    default:
      return TOOL_BAD_USAGE;
    }
    if (!good) {
      fprintf(stderr, "shade-render: '%s' is out of range; see --help\n", optarg);
      return TOOL_BAD_USAGE;
    }
  }
  return parse_names(argc, argv, o);
}

/* Is the pass among those of --passes? */
static bool is_wanted(const options *o, const char *name) {
  size_t length = strlen(name);
  for (const char *at = o->passes; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL)
    if (strncmp(at, name, length) == 0 && (at[length] == ',' || !at[length]))
      return true;
  return !o->passes;
}

/* What is written: rows from the top, all channels of a pixel beside each other. */
typedef struct sheet {
  int region[4]; /* of the picture: from the left and below */
  size_t width, height, channels;
  char *name[SHADE_IMAGE_MAX_CHANNELS];
  float *pixel;
} sheet;

/* Those of one pass have no more than their letter, as in Blender. */
static char *name_of(const scene_picture *p, const scene_pass *pass, bool alone, char letter) {
  size_t size = strlen(p->layer) + strlen(pass->name) + 4;
  char *name = malloc(size);
  if (name && alone)
    snprintf(name, size, "%c", letter);
  else if (name)
    snprintf(name, size, "%s.%s.%c", p->layer, pass->name, letter);
  return name;
}

static int name_channels(const options *o, const scene_picture *p, bool alone, sheet *to) {
  for (size_t k = 0; k < p->passes; k++)
    for (const char *c = p->pass[k].channels; *c && is_wanted(o, p->pass[k].name); c++) {
      if (to->channels == SHADE_IMAGE_MAX_CHANNELS)
        return complain("%s: passes must have %zu channels at most", o->scene, to->channels);
      char *name = name_of(p, &p->pass[k], alone, *c);
      if (!name)
        return complain("%s: out of memory", o->scene);
      for (size_t i = 0; i < to->channels; i++)
        if (strcmp(name, to->name[i]) == 0) {
          free(name);
          return complain("%s: passes must have channel %s once", o->scene, to->name[i]);
        }
      to->name[to->channels++] = name;
    }
  return TOOL_DONE;
}

/* What a pass shows, behind the channels that are there. */
static bool put(render *r, const scene_pass *pass, size_t at, sheet *to) {
  size_t width = (size_t)(r->region[2] - r->region[0]);
  size_t stride = (size_t)render_channels(r, pass->plane);
  float *plane = malloc(stride * width * (size_t)(r->region[3] - r->region[1]) * sizeof *plane);
  if (!plane)
    return false;
  render_copy_word(r, pass->plane, plane);
  for (size_t y = 0; y < to->height; y++) {
    size_t row = (size_t)(to->region[3] - 1 - r->region[1]) - y;
    const float *from = plane + stride * (row * width + (size_t)(to->region[0] - r->region[0]));
    float *pixel = to->pixel + to->channels * y * to->width + at;
    for (size_t x = 0; x < to->width; x++, from += stride, pixel += to->channels)
      for (int c = 0; pass->channels[c]; c++)
        pixel[c] = c < 3 && pass->exposure != 1.0f ? from[c] * pass->exposure : from[c];
  }
  free(plane);
  return true;
}

/* What a job that is done has of the passes; the first of its channels is at *at. */
static int put_passes(const options *o, const scene_picture *p, render *r, size_t *at, sheet *to) {
  for (size_t k = 0; k < p->passes; k++)
    if (is_wanted(o, p->pass[k].name)) {
      if (!put(r, &p->pass[k], *at, to))
        return complain("%s: out of memory", o->scene);
      *at += strlen(p->pass[k].channels);
    }
  return TOOL_DONE;
}

static int check_passes(const options *o, const scene_picture *p, const render *r) {
  for (size_t k = 0; k < p->passes; k++)
    if (render_channels(r, p->pass[k].plane) < (int)strlen(p->pass[k].channels))
      return complain(
          "%s: pass %s: plane '%s' must be one that the scene has, of %zu channels or more",
          o->scene, p->pass[k].name, p->pass[k].plane, strlen(p->pass[k].channels));
  return TOOL_DONE;
}

/* Until it is finished, or Ctrl-C has ended it. `begin`, `share`: of the whole work. */
static int await(const options *o, job *j, double begin, double share) {
  double told = 0;
  for (double waited = 0; !job_wait(j, 0.05); waited += 0.05) {
    if (tool_interrupted())
      job_cancel(j);
    if (o->progress && waited - told >= 2) {
      fprintf(stderr, "shade-render: %d %%\n", (int)(100 * (begin + share * job_progress(j))));
      told = waited;
    }
  }
  for (size_t k = 0; k < j->log.warnings && k < MESSAGE_WARNINGS; k++)
    fprintf(stderr, "shade-render: warning: %s\n",
            j->log.warning[k] ? j->log.warning[k] : "out of memory");
  if (job_get_state(j) == JOB_DONE)
    return tool_interrupted() ? TOOL_INTERRUPTED : TOOL_DONE;
  return job_get_state(j) == JOB_FAILED ? complain("%s: %s", o->scene, j->log.error)
                                        : TOOL_INTERRUPTED;
}

/* Whole tiles of the region that the sheet shows a part of, so that its pixels round as those of
 * the region. */
static void apply(const options *o, const sheet *to, scene *s) {
  if (o->samples)
    s->samples = (int)o->samples;
  if (o->has_seed)
    s->seed = (uint32_t)o->seed;
  if (o->threads)
    s->threads = (int)o->threads;
  if (o->has_share) {
    s->share[0] = (size_t)o->share[0];
    s->share[1] = (size_t)o->share[1];
  }
  s->features.denoise = s->features.denoise && !o->to_share;
  for (int k = 0; k < 2; k++) {
    int low = to->region[k] / TILE_SIDE * TILE_SIDE;
    int high = (to->region[k + 2] + TILE_SIDE - 1) / TILE_SIDE * TILE_SIDE;
    s->region[k] = low > s->region[k] ? low : s->region[k];
    s->region[k + 2] = high < s->region[k + 2] ? high : s->region[k + 2];
  }
}

/* False where the part that is asked for is not in the scene's region. */
static bool place(const options *o, const scene *s, sheet *to) {
  memcpy(to->region, s->region, sizeof to->region);
  if (o->has_tile) {
    to->region[0] = (int)o->tile[0];
    to->region[1] = s->height - (int)(o->tile[1] + o->tile[3]);
    to->region[2] = (int)(o->tile[0] + o->tile[2]);
    to->region[3] = s->height - (int)o->tile[1];
  }
  to->width = (size_t)(to->region[2] - to->region[0]);
  to->height = (size_t)(to->region[3] - to->region[1]);
  return to->region[0] >= s->region[0] && to->region[1] >= s->region[1] &&
         to->region[2] <= s->region[2] && to->region[3] <= s->region[3];
}

/* Where the pictures come from, and where else than a sheet they go: NULL where not. */
typedef struct shares {
  share_set *from;
  share_writer *to;
} shares;

static int put_share(share_writer *w, const render *r, const sheet *to) {
  char error[512];
  return share_put(w, r, to->region, error, sizeof error) ? TOOL_DONE : complain("%s", error);
}

static int render_picture(const options *o, scene_picture *p, double begin, double share,
                          const shares *by, size_t *at, sheet *to) {
  job *j = job_start_filled(p->scene, by->from ? share_fill : NULL, by->from); /* which frees it */
  p->scene = NULL;
  if (!j)
    return complain("%s: out of memory or threads", o->scene);
  int status = check_passes(o, p, &j->render);
  if (status == TOOL_DONE)
    status = await(o, j, begin, share);
  if (status == TOOL_DONE)
    status = by->to ? put_share(by->to, &j->render, to) : put_passes(o, p, &j->render, at, to);
  job_free(j);
  return status;
}

static bool has_wanted(const options *o, const scene_picture *p) {
  bool wanted = false;
  for (size_t k = 0; k < p->passes; k++)
    wanted = wanted || is_wanted(o, p->pass[k].name);
  return wanted;
}

/* All pictures, into a sheet whose channels have names. */
static int render_pictures(const options *o, scene_file *f, const shares *by, sheet *to) {
  size_t at = 0;
  int status = TOOL_DONE;
  double share = 1.0 / (double)f->pictures;
  for (size_t k = 0; status == TOOL_DONE && k < f->pictures; k++) {
    if (by->from)
      by->from->picture = k;
    if (has_wanted(o, &f->picture[k]))
      status = render_picture(o, &f->picture[k], share * (double)k, share, by, &at, to);
  }
  return status;
}

static int render_all(const options *o, scene_file *f, sheet *to) {
  share_set set = {.count = 0};
  const shares by = {.from = o->merge ? &set : NULL};
  char error[512];
  to->pixel = malloc(to->channels * to->width * to->height * sizeof(float));
  if (!to->pixel)
    return complain("%s: out of memory", o->scene);
  int status = TOOL_DONE;
  if (o->merge &&
      !share_open(&set, (const char *const *)o->shares, o->share_count, f, error, sizeof error))
    status = complain("%s", error);
  if (status == TOOL_DONE)
    status = render_pictures(o, f, &by, to);
  share_close(&set);
  return status;
}

/* Whether a part of the picture can be told from the rest; else the reason is said. */
static int check_share(const options *o, const scene_file *f) {
  for (size_t k = 0; k < f->pictures; k++) {
    const scene *s = f->picture[k].scene;
    const size_t samples = (size_t)s->samples;
    if (s->time_limit > 0.0f)
      return complain(
          "%s: it has a Time Limit, by which parts would have samples of other numbers; "
          "save it without",
          o->scene);
    if (!o->has_share)
      continue;
    if ((size_t)o->share[1] > samples)
      return complain("--share must be within the %zu samples of a pixel", samples);
    if (s->adaptive_threshold > 0.0f)
      return complain("%s: adaptive sampling goes by all samples of a pixel, so that there are no "
                      "shares of them; save it with a fixed number, or render tiles",
                      o->scene);
    if (s->cloths && !(sampling_is_cut(samples, (size_t)o->share[0]) &&
                       sampling_is_cut(samples, (size_t)o->share[1])))
      return complain("%s: it has cloth, whose samples are shaded together: --share must begin and "
                      "end at 0, 4, 16, a multiple of 64 or the last sample",
                      o->scene);
  }
  return TOOL_DONE;
}

static int save_share(const options *o, scene_file *f, sheet *to) {
  char error[512];
  share_writer writer;
  const shares by = {.to = &writer};
  int status = check_share(o, f);
  if (status != TOOL_DONE)
    return status;
  bool good = share_begin(&writer, o->output, f, to->region, error, sizeof error);
  if (!good)
    status = complain("%s", error);
  else
    status = render_pictures(o, f, &by, to);
  if (!share_end(&writer, status == TOOL_DONE, error, sizeof error) && status == TOOL_DONE)
    status = complain("%s", error);
  return status;
}

/* A file that was begun when Ctrl-C came goes. */
static int write_sheet(const options *o, const shade_image_spec *spec, const sheet *to) {
  char error[512];
  shade_image_writer *w = shade_image_open(o->output, spec, error, sizeof error);
  int status = TOOL_DONE;
  if (!w || shade_image_rows(w, to->pixel, spec->height, error, sizeof error) != 0)
    status = complain("%s", error);
  else if (tool_interrupted())
    status = TOOL_INTERRUPTED;
  if (status == TOOL_DONE)
    return shade_image_close(w, error, sizeof error) == 0 ? TOOL_DONE : complain("%s", error);
  shade_image_abandon(w);
  return status;
}

static int save(const options *o, const scene *s, scene_file *f, sheet *to) {
  const int within[] = {to->region[0], s->height - to->region[3], s->width, s->height};
  shade_image_text *texts = malloc((f->texts + 1) * sizeof *texts);
  if (!texts)
    return complain("%s: out of memory", o->scene);
  for (size_t k = 0; k < f->texts; k++)
    texts[k] = (shade_image_text){f->text[k].name, f->text[k].text};
  const shade_image_spec spec = {.width = (int)to->width,
                                 .height = (int)to->height,
                                 .channels = (int)to->channels,
                                 .names = (const char *const *)to->name,
                                 .type = SHADE_IMAGE_FLOAT,
                                 .within = within,
                                 .texts = texts,
                                 .text_count = f->texts};
  char error[512];
  int status = shade_whole_write(o->output, NULL, 0, error, sizeof error) == 0
                   ? render_all(o, f, to)
                   : complain("%s: %s", o->output, error);
  if (status == TOOL_DONE)
    status = write_sheet(o, &spec, to);
  free(texts);
  return status;
}

static int render_file(const options *o, scene_file *f) {
  const scene *s = f->picture->scene;
  sheet to = {.channels = 0};
  bool alone = f->pictures == 1 && f->picture->passes == 1;
  int status = TOOL_DONE;
  for (size_t k = 0; status == TOOL_DONE && k < f->pictures; k++)
    status = name_channels(o, &f->picture[k], alone, &to);
  if (status == TOOL_DONE && !to.channels)
    status = complain("%s: none of these passes is in the scene", o->scene);
  else if (status == TOOL_DONE && !place(o, s, &to))
    status = complain("--tile must be within what the scene shows of its picture");
  for (size_t k = 0; status == TOOL_DONE && k < f->pictures; k++)
    apply(o, &to, f->picture[k].scene);
  if (status == TOOL_DONE)
    status = o->to_share ? save_share(o, f, &to) : save(o, s, f, &to);
  while (to.channels)
    free(to.name[--to.channels]);
  free(to.pixel);
  return status;
}

int main(int argc, char **argv) {
  shade_port_begin(&argc, &argv);
  options o = {.progress = shade_port_is_terminal(2)};
  scene_file file = {0};
  int status = parse(argc, argv, &o);
  if (status != TOOL_DONE)
    return status < 0 ? TOOL_DONE : status;
  tool_catch_interrupts();
  status = scene_file_open(&file, o.scene) ? render_file(&o, &file)
                                           : complain("%s: %s", o.scene, file.error);
  scene_file_close(&file);
  return status;
}
