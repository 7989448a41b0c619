/* SPDX-License-Identifier: Apache-2.0 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "port/process.h"
#include "shade/shade.h"
#include "tool/tool.h"

static const struct {
  const char *name;
  int (*run)(int argc, char **argv);
  const char *help;
} commands[] = {
    {"eval", shade_cmd_eval, "evaluate a distribution or BRDF for queries on standard input"},
    {"bench", shade_cmd_bench, "time every method beside its error"},
    {"scratch", shade_cmd_scratch, "make a map of scratches"},
    {"presets", shade_cmd_presets, "cloths and metals by name, and their numbers"},
    {"fabric", shade_cmd_fabric, "what a cloth reflects, near and far"},
    {"swatch", shade_cmd_swatch, "pictures of cloths and metals by name"},
    {"slopes", shade_cmd_slopes, "look a normal map up with a footprint"},
    {"check", shade_cmd_check, "recompute a renderer's dump with the reference"},
    {"weave", shade_cmd_weave, "which yarn is on top of a woven cloth, drafts and maps of it"},
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static void usage(FILE *to) {
  fputs("usage: shade COMMAND [options]\n\n", to);
  for (int i = 0; i < COMMANDS; i++)
    fprintf(to, "  %-8s %s\n", commands[i].name, commands[i].help);
  fputs("\n  shade COMMAND --help   options of a command\n"
        "  shade --version        version and instruction set\n\n"
        "Exit status: 0 done, 1 bad input, 2 bad usage.\n",
        to);
}

/* An answer that did not reach its reader is no success. */
static int written(int status) {
  if (!fflush(stdout) && !ferror(stdout))
    return status;
  fprintf(stderr, "shade: standard output: %s\n", strerror(errno));
  return status ? status : TOOL_BAD_INPUT;
}

int main(int argc, char **argv) {
  shade_port_begin(&argc, &argv);
  if (argc < 2) {
    usage(stderr);
    return TOOL_BAD_USAGE;
  }
  if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") || !strcmp(argv[1], "help")) {
    usage(stdout);
    return written(TOOL_DONE);
  }
  char wrong[160];
  if (shade_isa_check(wrong, sizeof wrong))
    fprintf(stderr, "shade: warning: %s\n", wrong);
  if (!strcmp(argv[1], "--version")) {
    printf("shade %s (%s)\n", SHADE_VERSION, shade_isa());
    return written(TOOL_DONE);
  }
  for (int i = 0; i < COMMANDS; i++)
    if (!strcmp(argv[1], commands[i].name))
      return written(commands[i].run(argc - 1, argv + 1));
  fprintf(stderr, "shade: unknown command '%s'\n\n", argv[1]);
  usage(stderr);
  return TOOL_BAD_USAGE;
}
