// Three lessons, each a question, things to do, and what one sees.
export const LESSONS = {
  chaos: {
    title: "Chaos, and sixteen digits",
    scene: "gas",
    events: 300,
    question: "A double has sixteen digits. Ten discs fly in a box. How many collisions do sixteen digits last?",
    steps: [
      "Press “Run and play”, and watch “digits left” count down: each collision takes some of them.",
      "At the mark ◆ none are left: in doubles a disc meets another partner. Press “Why?”.",
      "Press “One ulp”: the same in doubles, from a start that differs by one bit. Choose it beside “engine”.",
    ],
    seen: "Errors grow by a factor at every collision, so digits go at a steady pace: twice the digits last about twice as long, and no number of them lasts for ever. The exact run loses none.",
  },
  tie: {
    title: "A tie that floats break",
    scene: "rack",
    events: 60,
    question: "A cue ball hits a rack in which all balls touch. Everything is symmetric. Does it stay so?",
    steps: [
      "Press “Run and play”, and look at both panes: is the upper half the mirror image of the lower half?",
      "Press “To the first divergence”, then “Why?”: which of two collisions came first?",
      "Move the cue ball up by a little (choose it, then press the arrow up), run again: now it is no tie.",
    ],
    seen: "Exactly, both collisions fall on one instant, and that is proved. In doubles one comes a rounding error before the other: what was a tie becomes an order, and the symmetry is gone.",
  },
  back: {
    title: "There and back",
    scene: "gas",
    events: 300,
    question: "Turn every velocity round, and the laws of motion lead back to the start. Do doubles find home?",
    steps: [
      "Set events to 60 and press “Turn back”: how far from home is each run at the end?",
      "Set events to 240, then to 300, and press it again.",
      "Play the last one: it is the same film backwards, until it is not.",
    ],
    seen: "The exact run comes home at any number of events, to the last digit. In doubles each event on the way costs digits twice, there and back; once they are used up, home is not found.",
  },
};
