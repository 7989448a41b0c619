/* SPDX-License-Identifier: Apache-2.0 */
/* What an x86-64 processor has. */
#ifndef SHADE_PORT_PROCESSOR_H
#define SHADE_PORT_PROCESSOR_H

/*
 * Whether this one, and its system, has a feature by the name that compilers give it, which must be
 * a literal. macOS saves the registers of AVX-512 only for who has used them, so that none but the
 * system itself can tell.
 */
#ifdef __APPLE__
#define shade_port_processor_has(feature) shade_port_system_has(feature)
int shade_port_system_has(const char *feature);
#else
#define shade_port_processor_has(feature) __builtin_cpu_supports(feature)
#endif

#endif
