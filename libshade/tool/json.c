/* SPDX-License-Identifier: Apache-2.0 */
#include "tool/json.h"
#include "src/json_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH_LIMIT = 32 };

typedef struct reader {
  const char *text, *at;
  char *error;
  size_t error_size;
} reader;

static json *read_value(reader *r, int depth);

/* Says what is wrong where the reader stands. Always NULL. */
static void *complain(const reader *r, const char *message) {
  int line = 1, column = 1;
  for (const char *c = r->text; c < r->at; c++) {
    column = *c == '\n' ? 1 : column + 1;
    line += *c == '\n';
  }
  snprintf(r->error, r->error_size, "line %d, column %d: %s", line, column, message);
  return NULL;
}

static void skip_space(reader *r) {
  r->at += strspn(r->at, " \t\r\n");
}

/* 1 and past it if `symbol` comes next. */
static int take(reader *r, char symbol) {
  skip_space(r);
  if (*r->at != symbol)
    return 0;
  r->at++;
  return 1;
}

static json *new_value(const reader *r, json_type type) {
  json *value = calloc(1, sizeof *value);
  if (!value)
    return complain(r, "out of memory");
  value->type = type;
  return value;
}

/* ---- strings --------------------------------------------------------------- */

/* Bytes of the UTF-8 sequence at `s`, or 0 if it is none. [RFC 3629 section 4] */
static int utf8_length(const unsigned char *s) {
  const int length = s[0] < 0x80 ? 1 : s[0] < 0xc2 ? 0 : s[0] < 0xe0 ? 2 : s[0] < 0xf0 ? 3 : 4;
  if (s[0] > 0xf4)
    return 0;
  for (int i = 1; i < length; i++)
    if ((s[i] & 0xc0) != 0x80)
      return 0;
  const int overlong = (s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xf0 && s[1] < 0x90);
  const int surrogate = s[0] == 0xed && s[1] > 0x9f;
  const int too_large = s[0] == 0xf4 && s[1] > 0x8f;
  return overlong || surrogate || too_large ? 0 : length;
}

static char *put_utf8(char *to, unsigned code) {
  if (code < 0x80) {
    *to++ = (char)code;
  } else if (code < 0x800) {
    *to++ = (char)(0xc0 | code >> 6);
    *to++ = (char)(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    *to++ = (char)(0xe0 | code >> 12);
    *to++ = (char)(0x80 | (code >> 6 & 0x3f));
    *to++ = (char)(0x80 | (code & 0x3f));
  } else {
    *to++ = (char)(0xf0 | code >> 18);
    *to++ = (char)(0x80 | (code >> 12 & 0x3f));
    *to++ = (char)(0x80 | (code >> 6 & 0x3f));
    *to++ = (char)(0x80 | (code & 0x3f));
  }
  return to;
}

/* The four digits after \u; -1 if they are none. */
static int read_hex(reader *r) {
  int code = 0;
  for (int i = 0; i < 4; i++, r->at++) {
    static const char digits[] = "0123456789abcdefABCDEF";
    const char *digit = *r->at ? strchr(digits, *r->at) : NULL;
    if (!digit)
      return -1;
    const int value = (int)(digit - digits);
    code = 16 * code + (value < 16 ? value : value - 6);
  }
  return code;
}

/* What follows a backslash, written to `to`; NULL with a message if it is no escape. */
static char *read_escape(reader *r, char *to) {
  static const char letters[] = "\"\\/bfnrt", meanings[] = "\"\\/\b\f\n\r\t";
  const char *letter = *r->at ? strchr(letters, *r->at) : NULL;
  if (letter) {
    r->at++;
    *to++ = meanings[letter - letters];
    return to;
  }
  if (*r->at++ != 'u')
    return complain(r, "unknown escape in a string");
  int code = read_hex(r);
  if (code >= 0xd800 && code < 0xdc00 && r->at[0] == '\\' && r->at[1] == 'u') {
    r->at += 2;
    const int low = read_hex(r);
    code = low >= 0xdc00 && low < 0xe000 ? 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00) : -1;
  }
  if (code <= 0 || (code >= 0xd800 && code < 0xe000))
    return complain(r, "\\u wants the four hex digits of a character");
  return put_utf8(to, (unsigned)code);
}

/* The string whose opening quote comes next; NULL with a message. */
static char *read_string(reader *r) {
  if (!take(r, '"'))
    return complain(r, "expected a string in double quotes");
  /* an escape is never shorter than what it stands for */
  const char *end = r->at;
  while (*end && *end != '"')
    end += *end == '\\' && end[1] ? 2 : 1;
  char *string = malloc((size_t)(end - r->at) + 1);
  if (!string)
    return complain(r, "out of memory");
  char *to = string;
  while (to && *r->at != '"') {
    const int length = utf8_length((const unsigned char *)r->at);
    if ((unsigned char)*r->at < 0x20)
      to = complain(r, *r->at ? "control character in a string" : "string without an end");
    else if (length == 0)
      to = complain(r, "string is not UTF-8");
    else if (*r->at == '\\') {
      r->at++;
      to = read_escape(r, to);
    } else {
      memcpy(to, r->at, (size_t)length);
      to += length;
      r->at += length;
    }
  }
  if (!to) {
    free(string);
    return NULL;
  }
  *to = 0;
  r->at++;
  return string;
}

/* ---- values ----------------------------------------------------------------- */

static size_t digits(const char *text) {
  return strspn(text, "0123456789");
}

static json *read_number(reader *r) {
  const char *end = r->at + (*r->at == '-');
  const size_t whole = digits(end);
  int good = whole == 1 || (whole > 1 && *end != '0');
  end += whole;
  if (*end == '.') {
    good = good && digits(end + 1);
    end += 1 + digits(end + 1);
  }
  if (*end == 'e' || *end == 'E') {
    end += 1 + (end[1] == '+' || end[1] == '-');
    good = good && digits(end);
    end += digits(end);
  }
  if (!good)
    return complain(r, "expected a value");
  json *value = new_value(r, JSON_NUMBER);
  if (!value)
    return NULL;
  value->number = strtod(r->at, NULL);
  if (!isfinite(value->number)) {
    json_free(value);
    return complain(r, "number too large");
  }
  r->at = end;
  return value;
}

static json *read_word(reader *r) {
  static const struct {
    const char *word;
    json_type type;
  } words[] = {{"null", JSON_NULL}, {"false", JSON_FALSE}, {"true", JSON_TRUE}};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    const size_t length = strlen(words[i].word);
    if (strncmp(r->at, words[i].word, length) == 0) {
      r->at += length;
      return new_value(r, words[i].type);
    }
  }
  return read_number(r);
}

/* One element, or one member with its key. */
static json *read_item(reader *r, json_type type, int depth) {
  char *key = NULL;
  if (type == JSON_OBJECT) {
    key = read_string(r);
    if (!key)
      return NULL;
    if (!take(r, ':')) {
      free(key);
      return complain(r, "expected ':' after a member's name");
    }
  }
  json *item = read_value(r, depth);
  if (item)
    item->key = key;
  else
    free(key);
  return item;
}

static json *read_list(reader *r, json_type type, int depth) {
  const char close = type == JSON_OBJECT ? '}' : ']';
  if (depth >= DEPTH_LIMIT)
    return complain(r, "nested too deep");
  json *list = new_value(r, type);
  r->at++;
  if (!list || take(r, close))
    return list;
  json **last = &list->child;
  do {
    *last = read_item(r, type, depth + 1);
    if (!*last) {
      json_free(list);
      return NULL;
    }
    last = &(*last)->next;
  } while (take(r, ','));
  if (take(r, close))
    return list;
  json_free(list);
  return complain(r, type == JSON_OBJECT ? "expected ',' or '}'" : "expected ',' or ']'");
}

static json *read_value(reader *r, int depth) {
  skip_space(r);
  if (*r->at == '{')
    return read_list(r, JSON_OBJECT, depth);
  if (*r->at == '[')
    return read_list(r, JSON_ARRAY, depth);
  if (*r->at != '"')
    return read_word(r);
  char *string = read_string(r);
  json *value = string ? new_value(r, JSON_STRING) : NULL;
  if (!value) {
    free(string);
    return NULL;
  }
  value->string = string;
  return value;
}

json *json_read(const char *text, char *error, size_t error_size) {
  reader r = {text, text, error, error_size};
  json *value = read_value(&r, 0);
  if (!value)
    return NULL;
  skip_space(&r);
  if (!*r.at)
    return value;
  json_free(value);
  return complain(&r, "expected the end of the text");
}

void json_free(json *value) {
  while (value) { /* siblings in turn; the depth of the recursion is the text's */
    json *next = value->next;
    json_free(value->child);
    free(value->string);
    free(value->key);
    free(value);
    value = next;
  }
}

const json *json_member(const json *object, const char *key) {
  if (!object || object->type != JSON_OBJECT)
    return NULL;
  for (const json *member = object->child; member; member = member->next)
    if (strcmp(member->key, key) == 0)
      return member;
  return NULL;
}

void json_print_string(FILE *to, const char *text) {
  fputc('"', to);
  for (; *text; text++) {
    char letter[JSON_LETTER];
    json_letter(*text, letter);
    fputs(letter, to);
  }
  fputc('"', to);
}
