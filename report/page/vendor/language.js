// SPDX-License-Identifier: Apache-2.0
// Stands before the libraries: uPlot formats numbers in the browser's language as it is loaded, and fails where that is no
// language tag ("en-US@posix").
try { new Intl.NumberFormat(navigator.language); } catch { Object.defineProperty(navigator, "language", {value: "en-US"}); }
