/* SPDX-License-Identifier: Apache-2.0 */
/* A program and what it was started by: arguments, streams, terminal, signals, environment,
 * modules. */
#ifndef SHADE_PORT_PROCESS_H
#define SHADE_PORT_PROCESS_H

#include <stddef.h>
#include <stdio.h>

/*
 * To be called first: arguments become UTF-8, standard streams carry bytes as they are, and a
 * terminal shows UTF-8. On POSIX systems all of that is so already.
 */
void shade_port_begin(int *count, char ***arguments);

/* Whether standard output (1) or standard error (2) is a terminal. */
int shade_port_is_terminal(int stream);

/* Have that called, with whatever number, when the user or the system asks this process to stop.
 * Reads go on. */
void shade_port_on_stop(void (*handler)(int));

/* Set a variable of the environment, or with NULL remove it. 0 or -1. */
int shade_port_set_variable(const char *name, const char *value);

/* The folder that this program is in, with / between names. 0, or -1 if it does not fit or cannot
 * be told. */
int shade_port_program_folder(char *path, size_t size);

/* How modules' names end: ".so" or ".dll". */
extern const char shade_port_module_ending[];

/* The address of a function in a module, which stays loaded. NULL, with what is wrong in
 * error[size]. */
void *shade_port_module_symbol(const char *path, const char *name, char *error, size_t size);

/* POSIX's getline. -1 at the end, and when out of memory. */
long long shade_port_line(char **line, size_t *capacity, FILE *file);

#endif
