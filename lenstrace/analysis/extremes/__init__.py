"""The extremes: lenses and rays at the edge of what numbers can say, judged against 50 digits."""
