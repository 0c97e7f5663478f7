function text = number_text(value)
%NUMBER_TEXT  A short text that reads back to the same number.
if isinteger(value)
    text = sprintf('%d', value);
    return
end
value = double(value);
text = sprintf('%.15g', value);
if str2double(text) ~= value
    text = sprintf('%.17g', value);
end
text = lower(text);  % nan and inf, as the program has them
end
