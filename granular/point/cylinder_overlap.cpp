#include "granular/point/cylinder_overlap.h"

#include "granular/point/surface_side.h"

namespace granular {
namespace {

/// An affine function of the contact plane.
struct PlaneHeight {
  Wide offset;
  Place slope;
  Wide at(const Place& p) const { return offset + slope.x * p.x + slope.y * p.y; }
};

/// What a cylinder shows the other: a cap, or a generator of its side, which begins at its deepest point.
struct Shown {
  Mask<Wide> cap;
  PlaneHeight height;           ///< of the cap's plane; of a generator: along it, the same at all places beside it
  Place from, to;               ///< a generator's ends
  Triple<Wide> centre, normal;  ///< a cap's, from the middle of the contact; outwards
  Wide radius;

  /// centre: from the middle of the contact, m; outwards: 1 where the look's z leads out of it, else -1.
  Shown(const LaneLook<Wide>& look, const Triple<Wide>& axis, const Triple<Wide>& centreOfBody, const Wide& ofRadius,
        const Wide& half, double outwards)
      : radius(ofRadius) {
    const Triple<Wide> out = outwards * look.z;
    const Wide cosine = out.dot(axis), end = signOf(cosine);
    cap = magnitude(cosine) >= flatterCosine;
    const Triple<Wide> toEnd = Wide(end * half) * axis;

    // The generator.
    const Triple<Wide> across = out - cosine * axis;
    const Wide reach = radius / choose(cap, spread(1), across.norm());
    const Triple<Wide> middle = centreOfBody + reach * across, first = middle + toEnd, last = middle - toEnd;
    const auto project = [&](const Triple<Wide>& p) { return Place{p.dot(look.x), p.dot(look.y)}; };
    from = project(first);
    to = project(last);
    const Wide heightFrom = first.dot(look.z), rise = last.dot(look.z) - heightFrom;
    const Place along = to - from;
    const Wide square = along.x * along.x + along.y * along.y;
    const Wide steepness = rise / choose(square > 0, square, spread(1));
    const Place slope = steepness * along;

    // The cap.
    centre = centreOfBody + toEnd;
    normal = end * axis;
    const Wide perHeight = 1 / choose(cap, Wide(outwards * magnitude(cosine)), spread(1));
    const Place tilt = {-normal.dot(look.x) * perHeight, -normal.dot(look.y) * perHeight};
    height.slope = choose(cap, tilt, slope);
    height.offset =
        choose(cap, Wide(normal.dot(centre) * perHeight), Wide(heightFrom - slope.x * from.x - slope.y * from.y));
  }

  /// From the cap's centre to where the cap lies over a place, in it.
  Triple<Wide> findInCap(const LaneLook<Wide>& look, const Place& p) const {
    const Triple<Wide> there = p.x * look.x + p.y * look.y + height.at(p) * look.z - centre;
    return there - normal.dot(there) * normal;
  }
};

Shown chooseShown(const Mask<Wide>& first, const Shown& a, const Shown& b) {
  Shown out = b;
  out.cap = first ? a.cap : b.cap;
  out.height = {choose(first, a.height.offset, b.height.offset), choose(first, a.height.slope, b.height.slope)};
  out.from = choose(first, a.from, b.from);
  out.to = choose(first, a.to, b.to);
  out.centre = choose<Wide>(first, a.centre, b.centre);
  out.normal = choose<Wide>(first, a.normal, b.normal);
  out.radius = choose(first, a.radius, b.radius);
  return out;
}

/// The part of a straight way that is left, as parts of its length.
struct Part {
  Wide begin{}, end = spread(1);
  Mask<Wide> left;  ///< any

  /// Keeps where an affine function that is a at the begin of the way and b at its end is not below 0.
  void keep(const Wide& a, const Wide& b) {
    const Mask<Wide> out = a < 0, in = b < 0;
    left = both(left, ~both(out, in));
    const Wide crossing = a / choose(either(out, in), Wide(a - b), spread(1));
    begin = choose(out, larger(begin, crossing), begin);
    end = choose(in, smaller(end, crossing), end);
  }
  /// Keeps where a parabola square t^2 + 2 half t + rest is not above 0.
  void keepBelow(const Wide& square, const Wide& half, const Wide& rest, const Mask<Wide>& which) {
    const Wide under = half * half - square * rest;
    const Mask<Wide> moves = square > 0;
    const Mask<Wide> meets = (moves & (under >= 0)) | (~moves & (rest <= 0));
    const Wide root = squareRoot(larger(under, Wide{})), divisor = choose(moves, square, spread(1));
    const Mask<Wide> cut = both(which, moves);
    begin = choose(cut, larger(begin, Wide((-half - root) / divisor)), begin);
    end = choose(cut, smaller(end, Wide((-half + root) / divisor)), end);
    left = both(left, either(~which, meets));
  }
};

}  // namespace

Wide integrateStrip(const CylinderPair<Wide>& pairs, const LaneLook<Wide>& look, const Mask<Wide>& seatIsA,
                    const Mask<Wide>& chosen, OverlapLanes& sums) {
  const Shown seat(look, pairs.seatAxis, -1.0 * look.middle, pairs.seatRadius, pairs.seatHalf, 1);
  const Shown guest(look, pairs.guestAxis, pairs.between - look.middle, pairs.guestRadius, pairs.guestHalf, -1);
  const Mask<Wide> thinIsSeat = both(~seat.cap, either(guest.cap, seatIsA));
  const Shown thin = chooseShown(thinIsSeat, seat, guest), wide = chooseShown(thinIsSeat, guest, seat);
  const Wide width = look.depth;
  const PlaneHeight depth = {seat.height.offset - guest.height.offset, seat.height.slope - guest.height.slope};

  // Where there is a depth, over the cap or beside the other generator.
  Part part;
  part.left = both(chosen, ~thin.cap);
  part.keep(depth.at(thin.from), depth.at(thin.to));
  const Triple<Wide> inCap = wide.findInCap(look, thin.from), along = wide.findInCap(look, thin.to) - inCap;
  part.keepBelow(along.dot(along), inCap.dot(along), inCap.dot(inCap) - wide.radius * wide.radius, wide.cap);
  const Place other = wide.to - wide.from, begin = thin.from - wide.from, end = thin.to - wide.from;
  const Wide square = other.x * other.x + other.y * other.y, length = squareRoot(square);
  const Mask<Wide> isLine = square > 0;
  const Wide perLength = 1 / choose(isLine, length, spread(1));
  const auto onOther = [&](const Place& p) -> Wide { return perLength * (other.x * p.x + other.y * p.y); };
  const auto beside = [&](const Place& p) -> Wide { return perLength * cross(other, p); };
  Part strip = part;
  strip.left = both(part.left, isLine);
  strip.keep(onOther(begin), onOther(end));
  strip.keep(length - onOther(begin), length - onOther(end));
  strip.keep(width + beside(begin), width + beside(end));
  strip.keep(width - beside(begin), width - beside(end));
  const Wide first = choose(wide.cap, part.begin, strip.begin), last = choose(wide.cap, part.end, strip.end);
  const Mask<Wide> left = both(wide.cap ? part.left : strip.left, last >= first);

  // The strip's integrals, as integrate(Segment) has them.
  const Place way = thin.to - thin.from, from = thin.from + first * way, to = thin.from + last * way;
  const Place piece = to - from, middle = spread(0.5) * (from + to);
  const Wide pieceLength = choose(left, squareRoot(Wide(piece.x * piece.x + piece.y * piece.y)), Wide{});
  const Wide deepFrom = smaller(depth.at(from), width), deepTo = smaller(depth.at(to), width);
  const Wide mean = 0.5 * (deepFrom + deepTo), lean = (deepTo - deepFrom) / 12.0;
  const Wide thickness = width / choose(pieceLength > 0, pieceLength, spread(1));
  const Place across = {-piece.y * thickness, piece.x * thickness};
  const Wide area = pieceLength * width, volume = area * mean;
  using Lanes = OverlapLanes;
  const auto put = [&](Lanes::Moment which, const Wide& x) { storeWide(choose(left, x, Wide{}), sums.moment[which]); };
  put(Lanes::area, area);
  put(Lanes::x, area * middle.x);
  put(Lanes::y, area * middle.y);
  put(Lanes::xx, area * (middle.x * middle.x + (piece.x * piece.x + across.x * across.x) / 12.0));
  put(Lanes::yy, area * (middle.y * middle.y + (piece.y * piece.y + across.y * across.y) / 12.0));
  put(Lanes::xy, area * (middle.x * middle.y + (piece.x * piece.y + across.x * across.y) / 12.0));
  put(Lanes::volume, volume);
  put(Lanes::volumeX, area * (mean * middle.x + lean * piece.x));
  put(Lanes::volumeY, area * (mean * middle.y + lean * piece.y));
  const Wide perVolume = 1 / choose(volume > 0, volume, spread(1));
  const Place press = {perVolume * area * (mean * middle.x + lean * piece.x),
                       perVolume * area * (mean * middle.y + lean * piece.y)};
  return 0.5 * (seat.height.at(press) + guest.height.at(press));
}

}  // namespace granular
