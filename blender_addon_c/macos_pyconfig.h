/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What CPython's headers ask of macOS, for modules of its stable ABI: those of Debian, which
 * macos.mk copies, have the answers for Linux. */
#ifndef Py_PYCONFIG_H
#define Py_PYCONFIG_H

#define WITH_THREAD 1

#define SIZEOF_SHORT 2
#define SIZEOF_INT 4
#define SIZEOF_LONG 8
#define SIZEOF_LONG_LONG 8
#define SIZEOF_VOID_P 8
#define SIZEOF_SIZE_T 8
#define SIZEOF_TIME_T 8
#define SIZEOF_WCHAR_T 4

#define HAVE_WCHAR_H 1
#define HAVE_STDDEF_H 1
#define HAVE_UNISTD_H 1
#define HAVE_SYS_STAT_H 1
#define HAVE_SYS_TIME_H 1
#define HAVE_SYS_TYPES_H 1

#endif
