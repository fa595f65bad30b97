#pragma once

#include <stdexcept>
#include <string>

namespace lambake {

/// Base of everything that lambake throws on purpose. `what()` is one line: where, what was expected,
/// what was found. Each kind has the exit code that the tool ends with.
class Error : public std::runtime_error {
 public:
  Error(const std::string& message, int exit_code) : std::runtime_error(message), exit_code_(exit_code) {}
  int exit_code() const { return exit_code_; }

 private:
  int exit_code_;
};

/// An option or a number given by the caller is out of its range (exit code 2).
class InvalidOption : public Error {
 public:
  explicit InvalidOption(const std::string& message) : Error(message, 2) {}
};

/// A file could not be read or written (exit code 3). `message` says the place in the file
/// ("line 7", "byte 312") and what was expected there.
class IoError : public Error {
 public:
  IoError(const std::string& path, const std::string& message) : Error(path + ": " + message, 3) {}
};

/// The file is well formed, but the scene in it cannot be processed (exit code 4).
class InvalidScene : public Error {
 public:
  explicit InvalidScene(const std::string& message) : Error(message, 4) {}
};

}  // namespace lambake
