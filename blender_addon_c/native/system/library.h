/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Shared libraries of our own. Blender and other add-ons bring other versions of
 * Embree and OpenEXR, sometimes in the global symbol scope, where a plain link
 * would bind to them: then every ray misses, silently. So each library is opened
 * from the module's lib/ folder (else by the system's name) in a scope of its
 * own, and its functions are looked up one by one.
 */
#ifndef LIBSHADE_LIBRARY_H
#define LIBSHADE_LIBRARY_H

#include <stddef.h>

/* Open `name`, e.g. "libembree3.so.3". NULL and a message on failure. Never closed. */
void *library_open(const char *name, char *error, size_t error_size);

/* dlsym with the arguments that shade_exr_api_load expects. */
void *library_symbol(void *library, const char *name);

#endif
