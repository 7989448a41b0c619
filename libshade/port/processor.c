/* SPDX-License-Identifier: Apache-2.0 */
#include "port/processor.h"

#ifdef __APPLE__

#include <stdio.h>
#include <string.h>
#include <sys/sysctl.h>

int shade_port_system_has(const char *feature) {
  /* those that it names otherwise */
  static const char *const names[][2] = {{"avx2", "avx2_0"}, {"bmi", "bmi1"}};
  char name[64];
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (!strcmp(feature, names[i][0]))
      feature = names[i][1];
  snprintf(name, sizeof name, "hw.optional.%s", feature);
  int has = 0;
  size_t size = sizeof has;
  return sysctlbyname(name, &has, &size, NULL, 0) == 0 && has;
}

#endif
