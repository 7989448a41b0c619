/* SPDX-License-Identifier: Apache-2.0 */
/* Windows alone: its header, and texts as it takes and gives them. */
#ifndef SHADE_PORT_WIDE_H
#define SHADE_PORT_WIDE_H
#ifdef _WIN32

#define WIN32_LEAN_AND_MEAN
#define NOMINMAX
#include <windows.h>

#include <errno.h>
#include <stdlib.h>

/* To be freed; NULL with errno where the text is no UTF-8, or when out of memory. */
static inline wchar_t *shade_port_wide(const char *text) {
  const int length = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, NULL, 0);
  wchar_t *wide = length > 0 ? malloc((size_t)length * sizeof *wide) : NULL;
  if (wide)
    MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, wide, length);
  else
    errno = length > 0 ? ENOMEM : EILSEQ;
  return wide;
}

/*
 * The name of a file as Windows has no limit for it: absolute and behind \\?\ where it, or what
 * is written beside it, comes near the 260 characters that it takes without. To be freed; NULL with
 * errno.
 */
wchar_t *shade_port_wide_name(const char *path);

/* To be freed; what is no character becomes U+FFFD. NULL when out of memory. */
static inline char *shade_port_narrow(const wchar_t *wide) {
  const int length = WideCharToMultiByte(CP_UTF8, 0, wide, -1, NULL, 0, NULL, NULL);
  char *text = length > 0 ? malloc((size_t)length) : NULL;
  if (text)
    WideCharToMultiByte(CP_UTF8, 0, wide, -1, text, length, NULL, NULL);
  else
    errno = ENOMEM;
  return text;
}

#endif
#endif
