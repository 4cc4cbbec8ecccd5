"""Other libraries, asked the same questions.  Each adapter alone knows its library's conventions."""
