#pragma once

#include <functional>
#include <string>

/// \file All that is written to a terminal. Control characters of scenes, names, cells and options arrive
/// there as visible escapes.

namespace extremal::app {

/// Lines for standard output; each ends with a newline of the text.
void print(const std::string& text);

/// One line "error: …" on standard error, whatever the message contains; cut where it is very long.
void print_error(const std::string& message);

/// Lines below an error.
void print_help(const std::string& text);

/// A line of progress on standard error that is written over, and removed at the end. Only on a terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool wanted);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Shows `text` of each value; empty where nothing is shown.
  template <class Value>
  std::function<void(const Value&)> callback(std::string (*text)(const Value&)) const {
    if (!shown_) return {};
    return [text](const Value& value) { show(text(value)); };
  }

 private:
  static void show(const std::string& text);

  bool shown_;
};

}  // namespace extremal::app
