/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warnings and the one error of a job, from any thread. */
#ifndef LIBSHADE_MESSAGE_H
#define LIBSHADE_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>

#include "system/threads.h"

enum { MESSAGE_SIZE = 512, MESSAGE_WARNINGS = 64 };

typedef struct message_log {
  pthread_mutex_t lock;
  char error[MESSAGE_SIZE]; /* the first error; empty: none */
  size_t warnings;          /* of these at most MESSAGE_WARNINGS are kept */
  char *warning[MESSAGE_WARNINGS];
} message_log;

/* Warnings that are said again by each job of a scene which is built once. */
typedef struct message_list {
  size_t count;
  char *text[MESSAGE_WARNINGS];
} message_list;

void message_init(message_log *log);
void message_free(message_log *log);

#if defined(__GNUC__)
#define MESSAGE_FORMAT __attribute__((format(printf, 2, 3)))
#else
#define MESSAGE_FORMAT
#endif

/* Keep the first error; always returns false, so that a caller can return it. */
MESSAGE_FORMAT bool message_error(message_log *log, const char *format, ...);
MESSAGE_FORMAT void message_warn(message_log *log, const char *format, ...);

/* How many there are; those from `first` on, kept; these, once more. */
size_t message_warnings(message_log *log);
void message_keep(message_log *log, size_t first, message_list *kept);
void message_repeat(message_log *log, const message_list *kept);
void message_forget(message_list *kept);

#endif
