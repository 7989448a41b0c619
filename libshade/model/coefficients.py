#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Make model/coefficients.h: polynomials for elementary.h, with their errors.

    python3 libshade/model/coefficients.py > libshade/model/coefficients.h

Each polynomial interpolates its function at Chebyshev nodes in 60-digit
arithmetic, which is within a factor of about two of the best polynomial of
that degree. The error printed beside it is measured after rounding the
coefficients to their type.
"""
import struct
from decimal import Decimal, getcontext
from math import cos, pi

getcontext().prec = 60
LN2 = Decimal(2).ln()
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494")


def interpolate(function, low, high, terms):
    """Monomial coefficients of the polynomial through `terms` Chebyshev nodes."""
    nodes = [
        (low + high) / 2 + (high - low) / 2 * Decimal(cos(pi * (2 * i + 1) / (2 * terms)))
        for i in range(terms)
    ]
    newton = [function(x) for x in nodes]
    for level in range(1, terms):
        for i in range(terms - 1, level - 1, -1):
            newton[i] = (newton[i] - newton[i - 1]) / (nodes[i] - nodes[i - level])
    coefficients = [Decimal(0)] * terms
    for i in range(terms - 1, -1, -1):
        shifted = [Decimal(0)] + coefficients[:-1]
        coefficients = [s - nodes[i] * c for s, c in zip(shifted, coefficients)]
        coefficients[0] += newton[i]
    return coefficients


def rounded(value, single):
    number = float(value)
    return struct.unpack("f", struct.pack("f", number))[0] if single else number


def evaluate(coefficients, x):
    total = Decimal(0)
    for c in reversed(coefficients):
        total = total * x + c
    return total


def atanh_rest(z):
    """(log((1+s)/(1-s)) - 2s) / s^3 at z = s^2."""
    if z == 0:
        return Decimal(2) / 3
    s = z.sqrt()
    return (((1 + s) / (1 - s)).ln() - 2 * s) / (s * z)


def exp_rest(r):
    """(exp(r) - 1 - r) / r^2."""
    if r == 0:
        return Decimal(1) / 2
    return (r.exp() - 1 - r) / (r * r)


def log2_ratio(z):
    """log2((1+s)/(1-s)) / s at z = s^2."""
    return (2 + atanh_rest(z) * z) / LN2


def exp2_ratio(r):
    """(2^r - 1) / r."""
    return ((r * LN2).exp() - 1) / r if r else LN2


def exp2_error(r, p):
    return (p - exp2_ratio(r)) * r / (r * LN2).exp()


def erfcx(a):
    """exp(a^2) erfc(a), by the series of erf; good for a <= 6, where 16 of 60 digits cancel."""
    term = total = a
    n = 0
    while abs(term) > Decimal(10) ** -60:
        n += 1
        term *= 2 * a * a / (2 * n + 1)
        total += term
    return (a * a).exp() - 2 / PI.sqrt() * total


def atan_rest(z):
    """(atan(s) - s) / s^3 at z = s^2, z < 1/5."""
    total, term, n = Decimal(0), Decimal(-1), 3
    while abs(term) > Decimal(10) ** -60:
        total += term / n
        term *= -z
        n += 2
    return total


def worst(error, low, high, steps=2000):
    return max(abs(error(low + (high - low) * i / steps)) for i in range(steps + 1))


def emit(name, function, low, high, terms, single, relative, note):
    coefficients = [rounded(c, single) for c in interpolate(function, low, high, terms)]
    exact = [Decimal(c) for c in coefficients]
    bound = worst(lambda x: relative(x, evaluate(exact, x)), low, high)
    suffix = "f" if single else ""
    digits = 9 if single else 17

    def literal(c):
        value = f"{c:.{digits}g}"
        return value + ("" if "." in value else ".0") + suffix

    def horner(these, argument):
        text = ""
        for c in reversed(these):
            text = f"({literal(c)} + {argument} * {text})" if text else literal(c)
        return text

    if single:
        text = horner(coefficients, "(z)")
    else:  # two chains of half the length, for one is what a single call waits for; the last step
        # is Horner's, whose rounding is the least
        even, odd = (horner(coefficients[k::2], "((z) * (z))") for k in (1, 2))
        text = f"({literal(coefficients[0])} + (z) * ({even} + (z) * {odd}))"
    print(f"/* {note}: relative error {float(bound):.1e} */")
    print(f"#define {name}(z) {text}\n")


def split_ln2(single):
    """ln 2 as high + low, where high times a small whole number is exact."""
    keep = 2 ** (12 if single else 34)
    high = Decimal(int(LN2 * keep)) / keep
    return float(high), rounded(LN2 - high, single)


# REUSE-IgnoreStart
print("/* SPDX-License-Identifier: Apache-2.0 */")
# REUSE-IgnoreEnd
print("/* Made by coefficients.py; do not edit. */")
print("#ifndef SHADE_MODEL_COEFFICIENTS_H\n#define SHADE_MODEL_COEFFICIENTS_H\n")
# s = f/(2+f), 1+f in [sqrt(1/2), sqrt(2)]: |s| <= 3 - 2 sqrt(2)
LIMIT = (3 - 2 * Decimal(2).sqrt()) ** 2
# the same with 1+f in 2^-0.5865 to 2^0.5865, where bits stand for logarithms (0.0861 off)
SPREAD = (Decimal("0.5865") * LN2).exp()
LOG2_LIMIT = ((SPREAD - 1) / (SPREAD + 1)) ** 2
HALF = LN2 / 2 * Decimal("1.001")
EXP2_HALF = Decimal("0.5")
for single, tag, log_terms, exp_terms, log2_terms, exp2_terms, erfcx_terms, atan_terms in (
    (True, "F", 3, 5, 4, 6, 9, 5),
    (False, "D", 8, 12, 10, 13, 18, 12),
):

    unit = Decimal(2) ** -23 if single else Decimal(1)

    def log_error(z, p):
        return (p - atanh_rest(z)) * z / (2 + atanh_rest(z) * z)

    def exp_error(r, p):
        return (p - exp_rest(r)) * r * r / r.exp()

    emit(f"SHADE_LOG_{tag}", atanh_rest, Decimal(0), LIMIT, log_terms, single, log_error,
         "log((1+s)/(1-s)) = 2s + s^3 P(s^2)")
    emit(f"SHADE_EXP_{tag}", exp_rest, -HALF, HALF, exp_terms, single, exp_error,
         "exp(r) = 1 + r + r^2 P(r)")
    emit(f"SHADE_LOG2_{tag}", lambda z: log2_ratio(z) / unit, Decimal(0), LOG2_LIMIT, log2_terms,
         single, lambda z, p: p * unit / log2_ratio(z) - 1,
         f"log2((1+s)/(1-s)) = s P(s^2){' / 2^23' if single else ''}")
    emit(f"SHADE_EXP2_{tag}", exp2_ratio, -EXP2_HALF, EXP2_HALF, exp2_terms, single, exp2_error,
         "2^r = 1 + r P(r)")
    emit(f"SHADE_ATAN_{tag}", atan_rest, Decimal(0), (Decimal(2).sqrt() - 1) ** 2, atan_terms, single,
         lambda z, p: (p - atan_rest(z)) * z / (1 + atan_rest(z) * z),
         "atan(s) = s + s^3 P(s^2), s <= tan(pi/8)")

    # y = 1/(1 + 0.3 a) from 1 down to where exp(-a^2) leaves nothing of Beckmann's Lambda
    least = 1 / (1 + Decimal("0.3") * (Decimal("4.2") if single else 6))
    middle = Decimal(rounded((1 + least) / 2, single))

    def argument(z):
        return (1 / (z + middle) - 1) / Decimal("0.3")

    def lambda_error(z, p):
        a = argument(z)
        share = (-a * a).exp()
        exact = erfcx(a)
        doubled = 1 + share * (1 / (a * PI.sqrt()) - exact) if a > 0 else Decimal("inf")
        return (p - exact) * share / doubled

    emit(f"SHADE_ERFCX_{tag}", lambda z: erfcx(argument(z)), least - middle,
         1 - middle - Decimal("1e-20"), erfcx_terms, single, lambda_error,
         "erfcx(a) by z = 1/(1 + 0.3 a) - middle, as a share of 1 + 2 Lambda")
    suffix = "f" if single else ""
    digits = 9 if single else 17
    print(f"#define SHADE_ERFCX_LEAST_{tag} {rounded(least, single):.{digits}g}{suffix}")
    print(f"#define SHADE_ERFCX_MIDDLE_{tag} {rounded(middle, single):.{digits}g}{suffix}\n")
    high, low = split_ln2(single)
    print(f"#define SHADE_LN2_HIGH_{tag} {high:.{digits}g}{suffix}")
    print(f"#define SHADE_LN2_LOW_{tag} {low:.{digits}g}{suffix}")
    print(f"#define SHADE_LOG2E_{tag} {rounded(1 / LN2, single):.{digits}g}{suffix}\n")


def seen_rest(n):
    """2 (n - log(1 + n)) / n^2."""
    return 2 * (n - (1 + n).ln()) / (n * n) if n else Decimal(1)


emit("SHADE_SEEN", seen_rest, Decimal(0), Decimal(1), 6, True, lambda n, p: p / seen_rest(n) - 1,
     "n - 2 log(1 + n) = -n + n^2 P(n), for table_block.h")
print("#endif")
