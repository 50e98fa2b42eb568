#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "study/files/formats.hpp"

namespace extremal {
namespace {

using SourcePointer = std::shared_ptr<const Source>;

constexpr std::string_view blanks = " \t\r\n";
constexpr std::size_t shortest_header = 11;
constexpr std::size_t period_parameter = 11;  ///< counts from 1

/// Words of a text, with the line of the next.
class Words {
 public:
  explicit Words(const SourcePointer& source) : source_(source), rest_(source->text) { skip(); }

  bool done() const { return rest_.empty(); }
  Location here() const { return {source_, line_, 1}; }

  std::string_view next() {
    if (done()) throw SceneError({source_, line_, 1}, "the file ends within a solution");
    const std::string_view word = rest_.substr(0, rest_.find_first_of(blanks));
    rest_.remove_prefix(word.size());
    skip();
    return word;
  }

  /// Fortran's: an exponent may begin with D, or, of three digits, with its sign.
  double number() {
    const Location at = here();
    std::string word(next());
    std::replace(word.begin(), word.end(), 'D', 'E');
    const std::size_t sign = word.find_first_of("+-", 1);
    if (sign != std::string::npos && word[sign - 1] != 'E' && word[sign - 1] != 'e')
      word.insert(sign, 1, 'E');
    const char* begin = word.data() + (word.front() == '+');
    double value = 0;
    const auto [stop, error] = std::from_chars(begin, word.data() + word.size(), value);
    const bool tiny =
        error == std::errc::result_out_of_range;  // below the least number, or above the largest
    if (stop != word.data() + word.size() || (error != std::errc() && !tiny) || !std::isfinite(value))
      throw SceneError(at, fmt::format("'{}' is not a finite number", word));
    return tiny ? 0 : value;
  }

  std::string_view rest_of_line() {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end);
    skip();
    return line;
  }

 private:
  void skip() {
    const std::size_t count = std::min(rest_.find_first_not_of(blanks), rest_.size());
    line_ += static_cast<int>(std::count(rest_.begin(), rest_.begin() + count, '\n'));
    rest_.remove_prefix(count);
  }

  SourcePointer source_;
  std::string_view rest_;
  int line_ = 1;
};

std::vector<long> integers_in(std::string_view line) {
  std::vector<long> values;
  for (;;) {
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
    if (line.empty()) return values;
    long value = 0;
    const auto [stop, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    line.remove_prefix(stop - line.data());
    if (error != std::errc() || (!line.empty() && blanks.find(line.front()) == std::string_view::npos))
      return {};
    values.push_back(value);
  }
}

/// The line before a solution.
struct AutoHeader {
  long label, parameters_varied, points, columns, lines, intervals, parameters;
};

AutoHeader read_header(Words& words) {
  const Location at = words.here();
  const std::vector<long> v = integers_in(words.rest_of_line());
  if (v.size() < shortest_header) throw SceneError(at, "a solution of AUTO begins with a line of integers");
  const AutoHeader header{v[3], v[4], v[6], v[7], v[8], v[9], v.size() > 11 ? v[11] : 0};
  const long bounded[] = {header.parameters_varied, header.points, header.columns, header.lines,
                          header.parameters};
  if (*std::min_element(std::begin(bounded), std::end(bounded)) < 0)
    throw SceneError(at, "the numbers of points, columns and lines cannot be negative");
  return header;
}

GuessFile read_solution(Words& words, const AutoHeader& header, std::size_t n) {
  GuessFile guess;
  for (long k = 0; k < header.points; ++k) {
    guess.t.push_back(words.number());
    for (std::size_t column = 1; column < static_cast<std::size_t>(header.columns); ++column) {
      const double value = words.number();
      if (column <= n) guess.q.push_back(value);
    }
  }
  // Between the points and the parameters: which parameters vary, their rates and the rates of all points.
  const long rates =
      header.intervals > 0 ? 2 * header.parameters_varied + header.points * (header.columns - 1) : 0;
  for (long k = 0; k < rates; ++k) words.number();
  for (long k = 1; k <= header.parameters; ++k) {
    const double value = words.number();
    if (k == static_cast<long>(period_parameter) && value > 0) guess.duration = value;
  }
  return guess;
}

}  // namespace

bool is_auto_file(const std::string& text) {
  const std::size_t begin = std::min(text.find_first_not_of(blanks), text.size());
  return integers_in(std::string_view(text).substr(begin, text.find('\n', begin) - begin)).size() >=
         shortest_header;
}

GuessFile read_auto_file(const SourcePointer& source, const std::vector<std::string>& names,
                         const std::optional<Number>& orbit) {
  const Location whole{source, 0, 0};
  Words words(source);
  std::vector<long> labels;
  std::optional<GuessFile> chosen;
  while (!words.done()) {
    const Location at = words.here();
    const AutoHeader header = read_header(words);
    labels.push_back(header.label);
    if (orbit ? header.label != std::lround(orbit->value) : labels.size() > 1) {
      for (long k = 0; k < header.lines; ++k) words.rest_of_line();
      continue;
    }
    if (header.columns <= static_cast<long>(names.size()))
      throw SceneError(at, fmt::format("solution {} has {} variables; the scene has {} coordinates",
                                       header.label, header.columns - 1, names.size()));
    Words inside = words;
    chosen = read_solution(inside, header, names.size());
    check_times(chosen->t, [&](std::size_t) { return at; });
    for (long k = 0; k < header.lines; ++k) words.rest_of_line();
  }
  if (!orbit && labels.size() > 1)
    throw SceneError(whole, fmt::format("the file has the solutions {}; say which in [guess], as orbit = {}",
                                        fmt::join(labels, ", "), labels.front()));
  if (!chosen)
    throw SceneError(orbit->at, fmt::format("orbit = {}; '{}' has the solutions {}", orbit->value,
                                            source->name, fmt::join(labels, ", ")));
  return *chosen;
}

}  // namespace extremal
