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

size_t message_warnings(message_log *log) {
  pthread_mutex_lock(&log->lock);
  size_t count = log->warnings < MESSAGE_WARNINGS ? log->warnings : MESSAGE_WARNINGS;
  pthread_mutex_unlock(&log->lock);
  return count;
}

void message_keep(message_log *log, size_t first, message_list *kept) {
  size_t count = message_warnings(log);
  pthread_mutex_lock(&log->lock);
  for (size_t i = first; i < count && kept->count < MESSAGE_WARNINGS; i++)
    if (log->warning[i] && (kept->text[kept->count] = strdup(log->warning[i])))
      kept->count++;
  pthread_mutex_unlock(&log->lock);
}

void message_repeat(message_log *log, const message_list *kept) {
  for (size_t i = 0; i < kept->count; i++)
    message_warn(log, "%s", kept->text[i]);
}

void message_forget(message_list *kept) {
  while (kept->count)
    free(kept->text[--kept->count]);
}
