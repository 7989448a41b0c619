/* SPDX-License-Identifier: Apache-2.0 */
/* The subcommands of `shade`. Exit status: 0 done, 1 bad input, 2 bad usage. */
#ifndef SHADE_TOOL_H
#define SHADE_TOOL_H

#define DEGREE (3.14159265358979323846 / 180) /* in radians */

enum { TOOL_DONE = 0, TOOL_BAD_INPUT = 1, TOOL_BAD_USAGE = 2 };

/* argv[0] is the subcommand's name. */
int shade_cmd_eval(int argc, char **argv);
int shade_cmd_bench(int argc, char **argv);
int shade_cmd_check(int argc, char **argv);
int shade_cmd_scratch(int argc, char **argv);
int shade_cmd_slopes(int argc, char **argv);
int shade_cmd_weave(int argc, char **argv);
int shade_cmd_swatch(int argc, char **argv);
int shade_cmd_presets(int argc, char **argv);
int shade_cmd_fabric(int argc, char **argv);

#endif
