/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADE_TOOL_CHECK_H
#define SHADE_TOOL_CHECK_H

/* shade check: a renderer's dump against the reference. argv[0] is the subcommand's name. */
int shade_cmd_check(int argc, char **argv);

#endif
