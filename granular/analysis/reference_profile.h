// Published radial porosity profiles of random beds of equal spheres, to compare with.
#pragma once

namespace granular {

/// de Klerk (2003): porosity at z sphere diameters from the wall of a bed whose core has the given porosity.
///   z <= 0.637: 2.14 z^2 - 2.53 z + 1
///   beyond:     core + 0.29 exp(-0.6 z) cos(2.3 pi (z - 0.16)) + 0.15 exp(-0.9 z)
/// Expect a simulated bed within 0.05 diameters of its positions and 0.05 of its depths.
double evaluateDeKlerk(double z, double corePorosity = 0.37);

/// Benyahia and O'Neil (2005): mean porosity of a bed of spheres of diameter d in a tube of diameter D.
double evaluateMeanPorosity(double tubeOverSphere);

}  // namespace granular
