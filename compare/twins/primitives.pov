// SPDX-License-Identifier: Apache-2.0
// One bare shape with bumps under three lamps, for `make bench-povray`: Declare=Shape=0 to 9.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 3.2, -9> right 2*x up y angle 52 look_at <0, .85, 0> }
light_source { <-6, 8, -6> rgb .6 }
light_source { <7, 5, -4> rgb <.35, .40, .50> }
light_source { <2, 9, 6> rgb .55 }
#declare T = texture {
  pigment { rgb 1 }
  normal { bumps .2 scale .2 }
  finish {
    ambient 0 diffuse 0
    mdf { ashikhmin_shirley 120, 3 specular .6 fresnel schlick diffuse lambert .3 }
  }
}
#switch (Shape)
  #case (0) sphere { 0, 2.2 texture { T } } #break
  #case (1) torus { 1.6, .7 texture { T } rotate -60*x } #break
  #case (2) box { -1.6, 1.6 texture { T } rotate <20, 46, 0> } #break
  #case (3) plane { y, -1 texture { T } } #break
  #case (4) cylinder { -2*y, 2*y, 1.6 texture { T } rotate 20*x } #break
  #case (5) cone { -2*y, 2, 2*y, 1 texture { T } rotate 20*x } #break
  #case (6) lathe { cubic_spline 6, <0, -2>, <.1, -1.9>, <1.8, -1>, <1.2, .5>, <2, 1.8>, <2.1, 2.1> texture { T } } #break
  #case (7) sor { 6, <0, -2.1>, <.1, -1.9>, <1.8, -1>, <1.2, .5>, <2, 1.8>, <2.1, 2.1> texture { T } } #break
  #case (8) union { #for (I, 0, 29) sphere { <mod(I, 6) - 2.5, floor(I/6) - 2, 0>, .45 texture { T } } #end } #break
  #case (9)
    mesh {
      #for (I, 0, 39) #for (J, 0, 39)
        #local A = <I/10 - 2, J/10 - 1.5, 0>;
        smooth_triangle { A, <0, .1, -1>, A + .1*x, <.1, 0, -1>, A + .1*(x + y), <-.1, 0, -1> uv_vectors <I, J>, <I + 1, J>, <I + 1, J + 1> }
        smooth_triangle { A, <0, .1, -1>, A + .1*y, <.1, 0, -1>, A + .1*(x + y), <-.1, 0, -1> uv_vectors <I, J>, <I, J + 1>, <I + 1, J + 1> }
      #end #end
      texture { T }
    }
  #break
#end
