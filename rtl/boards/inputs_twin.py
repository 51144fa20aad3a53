"""Twin of inputs.v, cycle by cycle."""


class Inputs:
    """Debounced inputs, the place of an edge, and a halt; every bit of a mask is an input.

    Parameters
    ----------
    count : int
    bounce : int
        Cycles of bounce.
    """

    def __init__(self, count, bounce):
        self.bounce, self.away = bounce, [0] * count
        self.settling = self.seen = self.levels = self.watched = self.edges = self.hit = 0
        self.place = None

    def reset(self, pins):
        """A cycle with reset."""
        self.__init__(len(self.away), self.bounce)
        self.settling = self.seen = self.levels = pins

    def cycle(self, pins, positions, write=None):
        """A rising edge of the clock; ``write`` is what it writes to WATCH, if anything."""
        changed = calm = 0
        for i, away in enumerate(self.away):
            bit = 1 << i
            off = (self.seen ^ self.levels) & bit
            calm |= bit * (not off and not away)
            self.away[i] = away + 1 if off else max(away - 1, 0)
            if self.away[i] == self.bounce:
                self.away[i] = 0
                changed |= bit
        if not self.hit and not self.watched & ~calm:
            self.place = positions
        self.hit |= changed & self.watched & ~(self.seen ^ self.edges)
        self.levels ^= changed
        if write is not None:
            self.edges, self.watched, self.hit = write >> 16, write & 0xFFFF, 0
        self.settling, self.seen = pins, self.settling
