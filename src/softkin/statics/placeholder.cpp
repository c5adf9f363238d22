namespace softkin {}
