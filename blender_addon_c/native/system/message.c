/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/message.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void message_init(message_log *log) {
  memset(log, 0, sizeof *log);
  pthread_mutex_init(&log->lock, NULL);
}

void message_free(message_log *log) {
  for (size_t i = 0; i < MESSAGE_WARNINGS; i++)
    free(log->warning[i]);
  pthread_mutex_destroy(&log->lock);
}

bool message_error(message_log *log, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  pthread_mutex_lock(&log->lock);
  if (!log->error[0])
    vsnprintf(log->error, sizeof log->error, format, arguments);
  pthread_mutex_unlock(&log->lock);
  va_end(arguments);
  return false;
}

void message_warn(message_log *log, const char *format, ...) {
  char text[MESSAGE_SIZE];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  pthread_mutex_lock(&log->lock);
  if (log->warnings < MESSAGE_WARNINGS)
    log->warning[log->warnings] = strdup(text);
  log->warnings++;
  pthread_mutex_unlock(&log->lock);
}
