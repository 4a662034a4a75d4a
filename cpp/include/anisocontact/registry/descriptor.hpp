#pragma once
// What a surface, field, law or rule says of itself. Bindings, case schema, `info` and the
// conformance tests are made from these descriptions; nothing else lists names or parameters.

#include <map>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace anisocontact {

/// Form of a parameter: one number, a pair, a spatial vector, an axis (a point and a direction), a
/// list, whole numbers, a switch, or one of a few words (whose place in `choices` is its value).
enum class Kind { scalar, pair, vector, axis, array, integer, integers, flag, choice };

/// What values a parameter may take.
enum class Bound { any, nonzero, positive, non_negative };

struct Parameter {
  std::string name;
  Kind kind;
  std::string unit;  ///< dimension: "length", "angle", "stress/length", "1", ...
  std::string doc;
  Bound bound{Bound::any};
  bool required{true};
  std::vector<double> fallback{};
  std::vector<std::string> choices{};
  /// What one number is multiplied with where it is given in the place of a list, to mean the same
  /// in all directions; none of a pair is 1, 1.
  std::vector<double> isotropic{};
};

struct Descriptor {
  std::string name;
  std::string doc;
  std::vector<Parameter> parameters;
  std::size_t directions{0};  ///< of a friction model: how many direction fields it is built on
};

/// Values of the parameters by name; every kind is a flat list of numbers.
class Values {
 public:
  Values() = default;
  explicit Values(std::map<std::string, std::vector<double>> values) : values_(std::move(values)) {}

  const std::vector<double>& list(const std::string& name) const {
    const auto it = values_.find(name);
    if (it == values_.end()) throw std::invalid_argument(name + " is missing");
    return it->second;
  }
  double scalar(const std::string& name) const { return at_least(name, 1)[0]; }
  bool flag(const std::string& name) const { return scalar(name) != 0.0; }
  const std::vector<double>& pair(const std::string& name) const { return at_least(name, 2); }
  const std::vector<double>& vector(const std::string& name) const { return at_least(name, 3); }
  const std::vector<double>& axis(const std::string& name) const { return at_least(name, 6); }
  bool has(const std::string& name) const { return values_.contains(name); }

 private:
  const std::vector<double>& at_least(const std::string& name, std::size_t n) const {
    const auto& v = list(name);
    if (v.size() < n)
      throw std::invalid_argument(name + " has " + std::to_string(v.size()) + " values, needs " +
                                  std::to_string(n));
    return v;
  }
  std::map<std::string, std::vector<double>> values_;
};

/// A list of registered types; the registry of a folder is one such list.
template <class... T>
struct Registry {
  using Any = std::variant<T...>;

  static std::vector<Descriptor> describe() { return {T::describe()...}; }

  /// The registered type called `name`, built from its values.
  static Any make(const std::string& name, const Values& values) {
    Any result;
    const bool found = ((T::describe().name == name && (result = T::make(values), true)) || ...);
    if (!found) throw std::invalid_argument("no entry called " + name);
    return result;
  }
};

}  // namespace anisocontact
