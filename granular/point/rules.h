// The contact-point rules behind one signature; contact_point.cpp holds their table.
#pragma once

#include "granular/point/contact_point.h"

namespace granular {

void placeFaceCentroid(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b,
                       const Frame& frameB, const Touch& touch, ContactPatch& out);
void placePressureCentroid(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b,
                           const Frame& frameB, const Touch& touch, ContactPatch& out);
void placePatch(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                const Touch& touch, ContactPatch& out);

}  // namespace granular
