/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Shared libraries of our own. Blender and other add-ons bring other versions of
 * Embree and OpenEXR, sometimes in the global symbol scope, where a plain link
 * would bind to them: then every ray misses, silently. So each library is opened
 * from the module's lib/ folder (else the system's, by its name) in a scope of its
 * own, and its functions are looked up one by one. Windows knows a library by the name of its file
 * alone: those of our own have names that nobody else has.
 */
#ifndef LIBSHADE_LIBRARY_H
#define LIBSHADE_LIBRARY_H

#include <stddef.h>

/*
 * Open the module's `own`, e.g. "embree", which is lib/libshade_embree.so, .dylib or .dll
 * (NULL: there is none), else the system's, e.g. "libembree4.so.4" (Windows and macOS have none of
 * these), or one by its path in UTF-8. NULL and a message on failure. Never closed.
 */
void *library_open(const char *own, const char *system, char *error, size_t error_size);

/* What the system calls Open Image Denoise of version 2. */
extern const char library_denoiser[];

/* dlsym with the arguments that shade_exr_api_load expects. */
void *library_symbol(void *library, const char *name);

#endif
