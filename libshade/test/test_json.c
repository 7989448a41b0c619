/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.3 */
/* The JSON reader: what RFC 8259 allows is read, all else is refused with its place. */
#include "tool/json.h"
#include "tool/work.h"

#include "shade/shade.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static char error[128];

static void test_values(void **state) {
  (void)state;
  json *value = json_read(" {\"a\": [1, -2.5e+1, 0, 0.125, 1E2], \"b\" : {\"c\":null},\n"
                          "\t\"t\":true,\"f\":false, \"e\": [], \"o\":{}, \"\": \"\"} \r\n",
                          error, sizeof error);
  assert_non_null(value);
  const json *item = json_member(value, "a")->child;
  const double numbers[] = {1, -25, 0, 0.125, 100};
  for (int i = 0; i < 5; i++, item = item->next) {
    assert_int_equal(item->type, JSON_NUMBER);
    assert_true(item->number == numbers[i]);
  }
  assert_null(item);
  assert_int_equal(json_member(json_member(value, "b"), "c")->type, JSON_NULL);
  assert_int_equal(json_member(value, "t")->type, JSON_TRUE);
  assert_int_equal(json_member(value, "f")->type, JSON_FALSE);
  assert_int_equal(json_member(value, "e")->type, JSON_ARRAY);
  assert_null(json_member(value, "e")->child);
  assert_int_equal(json_member(value, "o")->type, JSON_OBJECT);
  assert_string_equal(json_member(value, "")->string, "");
  assert_null(json_member(value, "absent"));
  assert_null(json_member(json_member(value, "a"), "a"));
  assert_null(json_member(NULL, "a"));
  json_free(value);
}

static void test_strings(void **state) {
  (void)state;
  const struct {
    const char *text, *value;
  } cases[] = {
      {"\"a\\\"\\\\\\/\\b\\f\\n\\r\\t\"", "a\"\\/\b\f\n\r\t"},
      {"\"\\u0041\\u00e9\\u20ac\\ud83d\\ude00\"", "A\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80"},
      {"\"\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80\"", "\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80"},
      {"\"\\u00E9\\u00AF\"", "\xc3\xa9\xc2\xaf"},
      {"\"\x7f\"", "\x7f"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    json *value = json_read(cases[i].text, error, sizeof error);
    if (!value)
      fail_msg("%s: %s", cases[i].text, error);
    assert_string_equal(value->string, cases[i].value);
    json_free(value);
  }
}

static void test_refused(void **state) {
  (void)state;
  const char *texts[] = {
      "",
      " ",
      "{",
      "}",
      "[",
      "[1",
      "[1,",
      "[1,]",
      "[,1]",
      "[1 2]",
      "{\"a\"}",
      "{\"a\":}",
      "{\"a\":1,}",
      "{a:1}",
      "{1:1}",
      "{\"a\" 1}",
      "{'a':1}",
      "\"",
      "\"a",
      "\"\\",
      "\"\\\"",
      "\"\\x\"",
      "\"\\u12\"",
      "\"\\u12g4\"",
      "\"\\u0000\"",
      "\"\\ud800\"",
      "\"\\udc00\"",
      "\"\\ud800\\u0041\"",
      "\"\\ud800\\",
      "\"\n\"",
      "\"\x01\"",
      "\"\xff\"",
      "\"\xc3\"",
      "\"\xc0\x80\"",
      "\"\xed\xa0\x80\"",
      "\"\xf5\x80\x80\x80\"",
      "\"\xe0\x80\x80\"",
      "\"\xf0\x80\x80\x80\"",
      "\"\xf4\x90\x80\x80\"",
      "\"\xf0\x9f\"",
      "01",
      "-",
      "+1",
      ".5",
      "1.",
      "1e",
      "1e+",
      "1e999",
      "-01",
      "0x10",
      "NaN",
      "nan",
      "Infinity",
      "inf",
      "-inf",
      "nul",
      "True",
      "1 2",
      "{} x",
      "// c\n1",
      "[1]]",
  };
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    error[0] = 0;
    json *value = json_read(texts[i], error, sizeof error);
    if (value)
      fail_msg("'%s' was read", texts[i]);
    assert_memory_equal(error, "line ", 5);
  }
  assert_null(json_read("[1,\n 2,\n  x]", error, sizeof error));
  assert_memory_equal(error, "line 3, column 3:", 17);
}

static void test_depth(void **state) {
  (void)state;
  enum { MANY = 1 << 20 };
  char *text = malloc(MANY + 1);
  memset(text, '[', MANY);
  text[MANY] = 0;
  assert_null(json_read(text, error, sizeof error));
  assert_non_null(strstr(error, "too deep"));
  memset(text + 32, ']', 32);
  text[64] = 0;
  json *value = json_read(text, error, sizeof error);
  assert_non_null(value);
  json_free(value);
  free(text);
}

/* Every beginning of a good text is refused, none reads past its end. */
static void test_beginnings(void **state) {
  (void)state;
  const char *whole =
      "{\"materials\": [{\"id\": 1, \"x\\u00e9\\ud83d\\ude00\xc3\xa9\": -1.5e-3}, true]}";
  for (size_t length = 0; length < strlen(whole); length++) {
    char *text = malloc(length + 1); /* of its own, so that ASan sees one byte too far */
    memcpy(text, whole, length);
    text[length] = 0;
    assert_null(json_read(text, error, sizeof error));
    free(text);
  }
}

static void test_print(void **state) {
  (void)state;
  FILE *file = tmpfile();
  char text[64] = "";
  json_print_string(file, "a\"\\\n\xc3\xa9%s");
  rewind(file);
  assert_non_null(fgets(text, sizeof text, file));
  fclose(file);
  assert_string_equal(text, "\"a\\\"\\\\\\u000a\xc3\xa9%s\"");
}

#ifndef _WIN32 /* whose header has a function of that name */
/* As where numbers have a comma: that library's own, for this program. */
static int commas;

int snprintf(char *restrict text, size_t size, const char *restrict format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(text, size, format, arguments);
  va_end(arguments);
  if (commas && !strcmp(format, "%.17g"))
    for (char *c = text; *c; c++)
      *c = *c == '.' ? ',' : *c;
  return length;
}

static void test_commas(void **state) {
  (void)state;
  shade_params p;
  char plain[4096], odd[4096];
  shade_params_init(&p);
  p.ex = 12.5;
  shade_params_json(&p, 3, "name", plain, sizeof plain);
  commas = 1;
  shade_params_json(&p, 3, "name", odd, sizeof odd);
  commas = 0;
  assert_string_equal(plain, odd);
  assert_non_null(strstr(odd, "12.5"));
}
#endif

/* More threads than processors: each step is taken, by one of them. */
enum { STEPS = 200000 };
static unsigned char taken[STEPS];

static void take_one(void *context, int thread, size_t step) {
  taken[step]++;
  ((size_t *)context)[16 * thread]++;
}

static void test_share(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 8, 31, 0, TOOL_MAX_THREADS + 5};
  for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
    static size_t counts[16 * (TOOL_MAX_THREADS + 1)];
    size_t sum = 0;
    memset(taken, 0, sizeof taken);
    memset(counts, 0, sizeof counts);
    tool_share(threads[k], STEPS, take_one, counts, NULL, 0, 1);
    for (size_t i = 0; i < STEPS; i++)
      assert_int_equal(taken[i], 1);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
      sum += counts[i];
    assert_int_equal(sum, STEPS);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_values),     cmocka_unit_test(test_strings),
      cmocka_unit_test(test_refused),    cmocka_unit_test(test_depth),
      cmocka_unit_test(test_beginnings), cmocka_unit_test(test_print),
      cmocka_unit_test(test_share),
#ifndef _WIN32
      cmocka_unit_test(test_commas),
#endif
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
