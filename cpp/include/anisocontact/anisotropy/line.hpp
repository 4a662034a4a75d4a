#pragma once
// Directions as lines: v and -v are the same, so what is interpolated is the tensor v (x) v.

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "anisocontact/anisotropy/field.hpp"

namespace anisocontact::anisotropy {

/// xx, xy, xz, yy, yz, zz of a sum of v (x) v.
template <class S>
using Line = std::array<S, 6>;

inline Line<double> line_of(const Vec3<double>& v) {
  return {v[0] * v[0], v[0] * v[1], v[0] * v[2], v[1] * v[1], v[1] * v[2], v[2] * v[2]};
}

/// u . L v.
template <class S>
S bilinear(const Line<S>& l, const Vec3<S>& u, const Vec3<S>& v) {
  return l[0] * u[0] * v[0] + l[1] * (u[0] * v[1] + u[1] * v[0]) +
         l[2] * (u[0] * v[2] + u[2] * v[0]) + l[3] * u[1] * v[1] +
         l[4] * (u[1] * v[2] + u[2] * v[1]) + l[5] * u[2] * v[2];
}

/// Agreement of the interpolated directions, (l_1 - l_2)/(l_1 + l_2) of the tangential part of the
/// sum: 1 where all are the same, 0 where they cancel. Below the limit there is no direction, as
/// around the pole of a field that the table is too coarse for.
inline constexpr double agreement_limit = 0.25;

/// Eigenvector of the largest eigenvalue of the tangential part of `l`, on the side of `towards`;
/// none where the directions behind `l` cancel or are along the normal.
template <class S>
std::optional<Vec3<S>> along_line(const surface::Geometry<S>& g, const Line<S>& l,
                                  const Vec3<double>& towards) {
  using std::sqrt;
  const Vec3<S> t1 = (S(1.0) / sqrt(g.a_co(0, 0))) * g.jet.d1[0];
  const Vec3<S> t2 = g.normal.cross(t1);
  const S l11 = bilinear(l, t1, t1), l22 = bilinear(l, t2, t2);
  const S cosine = l11 - l22, sine = S(2.0) * bilinear(l, t1, t2);  // of the double angle
  const S size = sqrt(cosine * cosine + sine * sine);
  const double tangential = value(l11) + value(l22);
  const double whole = value(l[0]) + value(l[3]) + value(l[5]);
  if (!(tangential > parallel_limit * whole)) return std::nullopt;
  if (!(value(size) > agreement_limit * tangential)) return std::nullopt;
  // half of the angle, from the larger of its cosine and sine
  S c, s;
  if (value(cosine) >= 0.0) {
    c = sqrt(S(0.5) * (S(1.0) + cosine / size));
    s = sine / (S(2.0) * size * c);
  } else {
    s = sqrt(S(0.5) * (S(1.0) - cosine / size));
    c = sine / (S(2.0) * size * s);
  }
  const Vec3<S> e = c * t1 + s * t2;
  return value(e).dot(towards) < 0.0 ? Vec3<S>(-e) : e;
}

/// A list of spatial vectors from a flat list of numbers.
inline std::vector<Vec3<double>> vectors_from(const std::vector<double>& flat,
                                              const std::string& name) {
  if (flat.size() % 3 != 0)
    throw std::invalid_argument(name + ": " + std::to_string(flat.size()) +
                                " numbers given, three for each vector needed");
  std::vector<Vec3<double>> v(flat.size() / 3);
  for (std::size_t i = 0; i < v.size(); ++i)
    v[i] = Vec3<double>(flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]);
  return v;
}

/// `count` unit vectors from a flat list of numbers.
inline std::vector<Vec3<double>> directions_from(const std::vector<double>& flat, std::size_t count,
                                                 const std::string& name) {
  auto v = vectors_from(flat, name);
  if (v.size() != count)
    throw std::invalid_argument(name + ": " + std::to_string(v.size()) + " vectors given, " +
                                std::to_string(count) + " needed, one for each point");
  for (std::size_t i = 0; i < count; ++i) {
    if (!(v[i].norm() > 0.0))
      throw std::invalid_argument(name + ": vector " + std::to_string(i) + " is zero");
    v[i].normalize();
  }
  return v;
}

/// One or two tables of unit directions: `vectors`, and `second_vectors` where they are given.
inline std::vector<std::vector<Vec3<double>>> tables_from(const Values& v, std::size_t count) {
  std::vector<std::vector<Vec3<double>>> t{directions_from(v.list("vectors"), count, "vectors")};
  if (!v.list("second_vectors").empty())
    t.push_back(directions_from(v.list("second_vectors"), count, "second_vectors"));
  return t;
}

/// Axes from interpolated unit tangents: the second is n x e_1 where only the first is tabulated.
template <class S>
Axes<S> tabulated_axes(const surface::Geometry<S>& g,
                       const std::array<std::optional<Vec3<S>>, 2>& e, std::size_t tables) {
  return tables == 2 ? pair_axes(g, e[0], e[1]) : orthonormal_axes(g, e[0], Turn{});
}

}  // namespace anisocontact::anisotropy
