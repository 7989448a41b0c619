/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The functions of OpenEXRCore that the dump uses, as a table, so that a program
 * that links the library and a plug-in that loads its own copy share dump.c.
 */
#ifndef SHADE_DUMP_EXR_H
#define SHADE_DUMP_EXR_H

#include <openexr.h>

#define SHADE_EXR_FUNCTIONS(FUNCTION)                                                              \
  FUNCTION(exr_get_default_error_message)                                                          \
  FUNCTION(exr_finish)                                                                             \
  /* reading */                                                                                    \
  FUNCTION(exr_start_read)                                                                         \
  FUNCTION(exr_get_count)                                                                          \
  FUNCTION(exr_get_storage)                                                                        \
  FUNCTION(exr_get_compression)                                                                    \
  FUNCTION(exr_get_data_window)                                                                    \
  FUNCTION(exr_get_channels)                                                                       \
  FUNCTION(exr_get_attribute_by_name)                                                              \
  FUNCTION(exr_get_scanlines_per_chunk)                                                            \
  FUNCTION(exr_read_scanline_chunk_info)                                                           \
  FUNCTION(exr_decoding_initialize)                                                                \
  FUNCTION(exr_decoding_choose_default_routines)                                                   \
  FUNCTION(exr_decoding_update)                                                                    \
  FUNCTION(exr_decoding_run)                                                                       \
  FUNCTION(exr_decoding_destroy)                                                                   \
  /* writing */                                                                                    \
  FUNCTION(exr_start_write)                                                                        \
  FUNCTION(exr_add_part)                                                                           \
  FUNCTION(exr_initialize_required_attr_simple)                                                    \
  FUNCTION(exr_add_channel)                                                                        \
  FUNCTION(exr_attr_set_string)                                                                    \
  FUNCTION(exr_write_header)                                                                       \
  FUNCTION(exr_write_scanline_chunk_info)                                                          \
  FUNCTION(exr_encoding_initialize)                                                                \
  FUNCTION(exr_encoding_choose_default_routines)                                                   \
  FUNCTION(exr_encoding_update)                                                                    \
  FUNCTION(exr_encoding_run)                                                                       \
  FUNCTION(exr_encoding_destroy)

/* Each member has the type and, less its prefix, the name of the function it points to. */
#define SHADE_EXR_MEMBER_(name) __typeof__(&name) name;
struct shade_exr_api {
  SHADE_EXR_FUNCTIONS(SHADE_EXR_MEMBER_)
};

#endif
