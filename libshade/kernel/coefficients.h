/* SPDX-License-Identifier: Apache-2.0 */
/* Made by coefficients.py; do not edit. */
#ifndef SHADE_COEFFICIENTS_H
#define SHADE_COEFFICIENTS_H

/* log((1+s)/(1-s)) = 2s + s^3 P(s^2): relative error 2.5e-09 */
#define SHADE_LOG_F(z) (0.666666865f + (z) * (0.3998878f + (z)*0.295799494f))

/* exp(r) = 1 + r + r^2 P(r): relative error 1.0e-08 */
#define SHADE_EXP_F(z)                                                                             \
  (0.5f +                                                                                          \
   (z) * (0.166665763f + (z) * (0.0416665524f + (z) * (0.00836323295f + (z)*0.00139262504f))))

#define SHADE_LN2_HIGH_F 0.693115234f
#define SHADE_LN2_LOW_F 3.19461833e-05f
#define SHADE_LOG2E_F 1.44269502f

/* log((1+s)/(1-s)) = 2s + s^3 P(s^2): relative error 5.3e-19 */
#define SHADE_LOG_D(z)                                                                             \
  (0.66666666666666663 +                                                                           \
   (z) * (0.40000000000000879 +                                                                    \
          (z) * (0.28571428570803614 +                                                             \
                 (z) * (0.22222222391713917 +                                                      \
                        (z) * (0.18181795640132906 +                                               \
                               (z) * (0.15386239702814658 +                                        \
                                      (z) * (0.13268773138656886 + (z)*0.13086626147840102)))))))

/* exp(r) = 1 + r + r^2 P(r): relative error 5.8e-19 */
#define SHADE_EXP_D(z)                                                                             \
  (0.5 +                                                                                           \
   (z) *                                                                                           \
       (0.16666666666666666 +                                                                      \
        (z) *                                                                                      \
            (0.041666666666666678 +                                                                \
             (z) *                                                                                 \
                 (0.0083333333333333332 +                                                          \
                  (z) *                                                                            \
                      (0.0013888888888879004 +                                                     \
                       (z) *                                                                       \
                           (0.00019841269841263252 +                                               \
                            (z) *                                                                  \
                                (2.4801587336630949e-05 +                                          \
                                 (z) * (2.7557319247344507e-06 +                                   \
                                        (z) * (2.755726307730941e-07 +                             \
                                               (z) * (2.5052070959803662e-08 +                     \
                                                      (z) * (2.091821231913398e-09 +               \
                                                             (z)*1.6086677666787362e-10)))))))))))

#define SHADE_LN2_HIGH_D 0.6931471805437468
#define SHADE_LN2_LOW_D 1.6198510186656561e-11
#define SHADE_LOG2E_D 1.4426950408889634

#endif
