/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.2 */
/*
 * The door to the system: names in any script and of any length, files that take another's place,
 * what stands in the way, lines of any length, waits that end. Runs on each system that the library
 * is made for.
 */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <string.h>

#include "dump/whole.h"
#include "port/files.h"
#include "port/map.h"
#include "port/memory.h"
#include "port/process.h"
#include "port/threads.h"
#include "support.h"
#include "test/posix.h"

#ifndef _WIN32
#include <sys/mman.h>
#endif

enum { DEEP = 24, LONGEST = 4096 };
static char folder[] = "/tmp/shade-port-XXXXXX";
static char error[256];

static int files_before;

static int set_up(void **state) {
  (void)state;
  files_before = next_file();
  return mkdtemp(folder) ? 0 : -1;
}
static int tear_down(void **state) {
  (void)state;
  return rmdir(folder);
}

static void keep(const char *path, const char *text) {
  assert_int_equal(shade_whole_write(path, text, strlen(text), error, sizeof error), 0);
}

static void holds(const char *path, const char *text) {
  char got[64] = "";
  FILE *file = shade_port_open(path, "rb");
  assert_non_null(file);
  const size_t length = fread(got, 1, sizeof got - 1, file);
  assert_int_equal(fclose(file), 0);
  assert_int_equal(length, strlen(text));
  assert_string_equal(got, text);
  long long size = -1;
  assert_int_equal(shade_port_look(path, &size), SHADE_PORT_FILE);
  assert_int_equal(size, length);
}

/* Cyrillic, CJK beyond the first 65536 characters too, a blank, marks that combine. */
static void names_of_any_script(void **state) {
  (void)state;
  static const char *const names[] = {
      "\xd0\xbf\xd0\xbb\xd0\xb0\xd1\x82\xd1\x8c\xd0\xb5.exr",
      "\xe5\xb8\x83 \xe7\xb9\x94\xe7\x89\xa9.exr",
      "\xf0\xa0\x80\x8b.exr",
      "cafe\xcc\x81.exr",
      "a b  c.exr",
  };
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, names[k]);
    assert_int_equal(shade_port_look(path, NULL), SHADE_PORT_NONE);
    assert_int_equal(errno, ENOENT);
    keep(path, "one\n");
    keep(path, "two\r\n"); /* in the other's place, byte for byte */
    holds(path, "two\r\n");
    assert_int_equal(shade_port_create(path), -1);
    assert_int_equal(errno, EEXIST);
    holds(path, "two\r\n");
    assert_int_equal(shade_port_remove(path), 0);
    assert_int_equal(shade_port_remove(path), -1);
    assert_int_equal(errno, ENOENT);
  }
}

#ifdef _WIN32
#include "port/wide.h"
/* That of C has a limit of length. */
static int make_folder_of_any_length(const char *path, int wanted) {
  char full[LONGEST];
  snprintf(full, sizeof full, "\\\\?\\%s", path);
  for (char *c = full; *c; c++)
    *c = *c == '/' ? '\\' : *c;
  wchar_t *wide = shade_port_wide(full);
  const int done = wanted ? CreateDirectoryW(wide, NULL) : RemoveDirectoryW(wide);
  free(wide);
  return done ? 0 : -1;
}
#else
static int make_folder_of_any_length(const char *path, int wanted) {
  return wanted ? mkdir(path, 0777) : rmdir(path);
}
#endif

static void names_of_any_length(void **state) {
  (void)state;
  static char path[LONGEST], file[LONGEST + sizeof "/cloth.exr"];
  size_t ends[DEEP];
#ifdef _WIN32
  assert_non_null(_fullpath(path, folder, sizeof path));
#else
  snprintf(path, sizeof path, "%s", folder);
#endif
  for (int k = 0; k < DEEP; k++) {
    ends[k] = strlen(path);
    snprintf(path + ends[k], sizeof path - ends[k],
             "/%02d-\xd1\x82\xd0\xba\xd0\xb0\xd0\xbd\xd1\x8c-of-sixty-letters-and-so-on", k);
    assert_int_equal(make_folder_of_any_length(path, 1), 0);
    snprintf(file, sizeof file, "%s/cloth.exr", path);
    keep(file, "deep");
    keep(file, "deeper");
    holds(file, "deeper");
    char *full = shade_port_full_name(file), *end = shade_port_end_of_links(file);
    assert_non_null(full);
    holds(full, "deeper");
    holds(end, "deeper");
    free(full);
    free(end);
    assert_int_equal(shade_port_remove(file), 0);
  }
  assert_true(strlen(file) > 1000);
  for (int k = DEEP - 1; k >= 0; k--) {
    assert_int_equal(make_folder_of_any_length(path, 0), 0);
    path[ends[k]] = 0;
  }
}

static void what_stands_in_the_way(void **state) {
  (void)state;
  char path[256];
  assert_int_equal(shade_port_look(folder, NULL), SHADE_PORT_FOLDER);
  assert_null(shade_port_open(folder, "wb"));
  assert_int_equal(errno, EISDIR);
  assert_int_equal(shade_whole_write(folder, "a", 1, error, sizeof error), -1);
  assert_string_equal(error, "cannot write: is a folder");
#ifdef _WIN32
  static const char nowhere[] = "NUL";
#else
  static const char nowhere[] = "/dev/null";
#endif
  assert_int_equal(shade_port_look(nowhere, NULL), SHADE_PORT_DEVICE);
  assert_int_equal(shade_whole_write(nowhere, "a", 1, error, sizeof error), -1);
  assert_string_equal(error, "cannot write: is a device or pipe, not a file");
  snprintf(path, sizeof path, "%s/none/a.exr", folder);
  assert_int_equal(shade_whole_write(path, "a", 1, error, sizeof error), -1);
  assert_string_equal(error, "cannot write: No such file or directory");
  snprintf(path, sizeof path, "%s/\xff\xfe.exr",
           folder); /* no UTF-8: a name on POSIX, none on Windows */
  shade_port_kind kind = shade_port_look(path, NULL);
  assert_int_equal(kind, SHADE_PORT_NONE);
  assert_null(shade_port_open("", "rb"));
  assert_int_equal(shade_port_look("", NULL), SHADE_PORT_NONE);
}

static void lines_of_any_length(void **state) {
  (void)state;
  char path[256];
  snprintf(path, sizeof path, "%s/lines", folder);
  FILE *file = shade_port_open(path, "wb+");
  assert_non_null(file);
  for (int k = 0; k < 5000; k++)
    fputc('a' + k % 26, file);
  fwrite("\n\nb\0c\r\nlast", 1, 11, file);
  rewind(file);
  char *line = NULL;
  size_t room = 0;
  assert_int_equal(shade_port_line(&line, &room, file), 5001);
  assert_int_equal(strlen(line), 5001);
  assert_int_equal(line[4999], 'a' + 4999 % 26);
  assert_int_equal(shade_port_line(&line, &room, file), 1);
  assert_string_equal(line, "\n");
  assert_int_equal(shade_port_line(&line, &room, file), 5);
  assert_memory_equal(line, "b\0c\r\n", 6);
  assert_int_equal(shade_port_line(&line, &room, file), 4);
  assert_string_equal(line, "last");
  assert_int_equal(shade_port_line(&line, &room, file), -1);
  free(line);
  fclose(file);
  assert_int_equal(shade_port_remove(path), 0);
}

static void files_as_memory(void **state) {
  (void)state;
  char path[256];
  size_t size = 0;
  snprintf(path, sizeof path, "%s/\xe5\xb8\x83", folder);
  assert_null(shade_port_map(path, &size));
  assert_int_equal(errno, ENOENT);
  keep(path, "");
  assert_null(shade_port_map(path, &size));
  assert_int_equal(errno, 0);
  keep(path, "a\r\nb");
  void *map = shade_port_map(path, &size);
  assert_non_null(map);
  assert_int_equal(size, 4);
  assert_memory_equal(map, "a\r\nb", 4);
  shade_port_unmap(map, size);
#ifndef _WIN32
  assert_int_equal(msync(map, size, MS_ASYNC), -1); /* given back */
  assert_int_equal(errno, ENOMEM);
#endif
  assert_int_equal(shade_port_remove(path), 0);
  assert_null(shade_port_map(folder, &size));
  assert_int_equal(errno, EINVAL);
}

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t changed = PTHREAD_COND_INITIALIZER;

/* The reference counts on 64 bits of mantissa, which Windows gives a thread only where it is asked
 * to. */
static void *third(void *given) {
  volatile long double one = 1, three = 3;
  *(long double *)given = one / three;
  return NULL;
}

static void threads_and_time(void **state) {
  (void)state;
  assert_true(shade_port_processors() >= 1);
  const double begun = shade_port_seconds();
  pthread_mutex_lock(&lock);
  shade_port_wait(&changed, &lock, 0.03);
  pthread_mutex_unlock(&lock);
  const double waited = shade_port_seconds() - begun;
  assert_true(waited >= 0.02 && waited < 5);
  long double here, there;
  pthread_t thread;
  third(&here);
  assert_int_equal(pthread_create(&thread, NULL, third, &there), 0);
  pthread_join(thread, NULL);
  assert_true(here == there);
}

static void this_process(void **state) {
  (void)state;
  char path[LONGEST], name[LONGEST + 16];
  assert_int_equal(shade_port_program_folder(path, sizeof path), 0);
  assert_null(strchr(path, '\\'));
  assert_int_equal(shade_port_look(path, NULL), SHADE_PORT_FOLDER);
  snprintf(name, sizeof name, "%s/none%s", path, shade_port_module_ending);
  assert_null(shade_port_module_symbol(name, "nothing", error, sizeof error));
  assert_true(strlen(error) > 5);
  assert_int_equal(shade_port_program_folder(path, 3), -1);
  assert_int_equal(shade_port_set_variable("SHADE_PORT_TEST", "one"), 0);
  assert_string_equal(getenv("SHADE_PORT_TEST"), "one");
  assert_int_equal(shade_port_set_variable("SHADE_PORT_TEST", "another"), 0);
  assert_string_equal(getenv("SHADE_PORT_TEST"), "another");
  assert_int_equal(shade_port_set_variable("SHADE_PORT_TEST", NULL), 0);
  assert_null(getenv("SHADE_PORT_TEST"));
  double *memory = shade_port_aligned_new(4 * SHADE_PORT_LINE);
  assert_non_null(memory);
  assert_int_equal((uintptr_t)memory % SHADE_PORT_LINE, 0);
  memset(memory, 1, 4 * SHADE_PORT_LINE);
  shade_port_aligned_free(memory);
  shade_port_aligned_free(NULL);
}

enum { ROOM = 1 << 20 };
static void *fill(void *sum) {
  volatile unsigned char room[ROOM];
  for (size_t k = 0; k < ROOM; k += 1024)
    room[k] = (unsigned char)(k >> 10 & 1);
  for (size_t k = 0; k < ROOM; k += 1024)
    *(int *)sum += room[k];
  return NULL;
}

static void threads_have_room(void **state) {
  (void)state;
  pthread_t thread;
  int sum = 0;
  assert_int_equal(shade_port_thread(&thread, fill, &sum), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
  assert_int_equal(sum, ROOM / 2048);
}

/* The last test: by those before it. */
static void all_files_were_closed(void **state) {
  (void)state;
  assert_int_equal(next_file(), files_before);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(names_of_any_script),    cmocka_unit_test(names_of_any_length),
      cmocka_unit_test(what_stands_in_the_way), cmocka_unit_test(lines_of_any_length),
      cmocka_unit_test(files_as_memory),        cmocka_unit_test(threads_and_time),
      cmocka_unit_test(this_process),           cmocka_unit_test(threads_have_room),
      cmocka_unit_test(all_files_were_closed),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
